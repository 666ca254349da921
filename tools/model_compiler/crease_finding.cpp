#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "tools/model_compiler/edge_map.h"
#include "tools/model_compiler/line_geometry.h"

namespace wirepose::tools {
namespace {

using Eigen::Vector3d;

double AngleBetween(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// One mesh edge that is a crease, or part of one.
struct Piece {
  EdgeKey edge;
  bool convex;
};

using FacePair = std::pair<int, int>;  // (smaller, larger), or (face, kOpen)

// Is the triangle `t`'s third vertex below the plane of the face that it meets at `edge`?
bool IsConvex(const mesh::Mesh& mesh, const EdgeKey& edge, int t, const Vector3d& other_normal) {
  for (const int v : mesh.triangles[t]) {
    if (v == edge.first || v == edge.second) continue;
    return other_normal.dot(mesh.vertices[v] - mesh.vertices[edge.first]) < 0;
  }
  return true;
}

// The pieces of all creases, grouped by the faces they part.
std::map<FacePair, std::vector<Piece>> CollectPieces(const mesh::Mesh& mesh, const std::vector<int>& face_of_triangle,
                                                     double crease_angle_rad) {
  std::map<FacePair, std::vector<Piece>> pieces;
  for (const auto& [edge, triangles] : MakeEdgeMap(mesh)) {
    if (triangles.size() == 1) {
      pieces[{face_of_triangle[triangles[0]], kOpen}].push_back({edge, true});
      continue;
    }
    double largest = crease_angle_rad;
    int first = -1, second = -1;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (std::size_t j = i + 1; j < triangles.size(); ++j) {
        if (face_of_triangle[triangles[i]] == face_of_triangle[triangles[j]]) continue;
        const double angle =
            AngleBetween(mesh.AreaNormal(mesh.triangles[triangles[i]]), mesh.AreaNormal(mesh.triangles[triangles[j]]));
        if (angle <= largest) continue;
        largest = angle;
        first = triangles[i];
        second = triangles[j];
      }
    }
    if (first < 0) continue;
    if (face_of_triangle[first] > face_of_triangle[second]) std::swap(first, second);
    pieces[{face_of_triangle[first], face_of_triangle[second]}].push_back(
        {edge, IsConvex(mesh, edge, second, mesh.AreaNormal(mesh.triangles[first]))});
  }
  return pieces;
}

// A straight run of pieces: an interval on the line through the first piece.
struct Run {
  double begin, end;  // m along the line
  int first_vertex, last_vertex;
  bool convex;
};

bool IsOnLine(const mesh::Mesh& mesh, const Piece& piece, const Vector3d& origin, const Vector3d& direction,
              double tolerance) {
  for (const int v : {piece.edge.first, piece.edge.second}) {
    const Vector3d offset = mesh.vertices[v] - origin;
    if ((offset - offset.dot(direction) * direction).norm() > tolerance) return false;
  }
  return true;
}

Run MakeRun(const mesh::Mesh& mesh, const Piece& piece, const Vector3d& origin, const Vector3d& direction) {
  const auto [a, b] = piece.edge;
  const double at_a = (mesh.vertices[a] - origin).dot(direction);
  const double at_b = (mesh.vertices[b] - origin).dot(direction);
  if (at_a <= at_b) return {at_a, at_b, a, b, piece.convex};
  return {at_b, at_a, b, a, piece.convex};
}

// Joins runs on one line where they touch.
std::vector<Run> JoinTouching(std::vector<Run> runs, double tolerance) {
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.begin < b.begin; });
  std::vector<Run> joined;
  for (const Run& run : runs) {
    if (!joined.empty() && run.begin <= joined.back().end + tolerance && run.convex == joined.back().convex) {
      if (run.end > joined.back().end) {
        joined.back().end = run.end;
        joined.back().last_vertex = run.last_vertex;
      }
    } else {
      joined.push_back(run);
    }
  }
  return joined;
}

// The straight runs of one pair of faces; it may have several lines (borders, faces that are not
// quite planar).
std::vector<Run> JoinPieces(const mesh::Mesh& mesh, std::vector<Piece> pieces, double tolerance) {
  const auto length = [&](const Piece& p) {
    return (mesh.vertices[p.edge.second] - mesh.vertices[p.edge.first]).norm();
  };
  std::stable_sort(pieces.begin(), pieces.end(), [&](const Piece& a, const Piece& b) { return length(a) > length(b); });
  std::vector<Run> all;
  while (!pieces.empty()) {
    const Vector3d origin = mesh.vertices[pieces[0].edge.first];
    const Vector3d direction = (mesh.vertices[pieces[0].edge.second] - origin).normalized();
    std::vector<Run> on_line;
    std::vector<Piece> rest;
    for (const Piece& piece : pieces) {
      if (IsOnLine(mesh, piece, origin, direction, tolerance)) {
        on_line.push_back(MakeRun(mesh, piece, origin, direction));
      } else {
        rest.push_back(piece);
      }
    }
    const std::vector<Run> joined = JoinTouching(std::move(on_line), tolerance);
    all.insert(all.end(), joined.begin(), joined.end());
    pieces = std::move(rest);
  }
  return all;
}

}  // namespace

std::vector<Crease> FindCreases(const mesh::Mesh& mesh, const std::vector<Face>& faces,
                                const std::vector<int>& face_of_triangle, double crease_angle_rad, double tolerance) {
  std::vector<Crease> creases;
  for (const auto& [pair, pieces] : CollectPieces(mesh, face_of_triangle, crease_angle_rad)) {
    for (const Run& run : JoinPieces(mesh, pieces, tolerance)) {
      Crease crease;
      crease.vertex = {std::min(run.first_vertex, run.last_vertex), std::max(run.first_vertex, run.last_vertex)};
      crease.face = {pair.first, pair.second};
      crease.length = (mesh.vertices[run.last_vertex] - mesh.vertices[run.first_vertex]).norm();
      if (pair.second != kOpen) crease.dihedral = AngleBetween(faces[pair.first].normal, faces[pair.second].normal);
      crease.convex = run.convex;
      creases.push_back(crease);
    }
  }
  // Lengths are compared as the file stores them, so that equal edges stay in the order of their
  // vertices.
  std::sort(creases.begin(), creases.end(), [](const Crease& a, const Crease& b) {
    const auto length_a = static_cast<float>(a.length), length_b = static_cast<float>(b.length);
    return length_a != length_b ? length_a > length_b : std::tie(a.vertex, a.face) < std::tie(b.vertex, b.face);
  });
  return creases;
}

}  // namespace wirepose::tools
