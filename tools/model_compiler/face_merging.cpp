#include <algorithm>
#include <cmath>
#include <numeric>

#include "tools/model_compiler/edge_map.h"
#include "tools/model_compiler/line_geometry.h"

namespace wirepose::tools {
namespace {

using Eigen::Vector3d;

// Compared with the seed's plane, not with the neighbour's: a finely tessellated sphere must not
// become one face.
bool LiesIn(const mesh::Mesh& mesh, int t, const Vector3d& normal, const Vector3d& point,
            const FaceTolerance& tolerance) {
  const Vector3d n = mesh.AreaNormal(mesh.triangles[t]).normalized();
  if (n.dot(normal) < std::cos(tolerance.angle_rad)) return false;
  return std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(),
                     [&](int v) { return std::abs(normal.dot(mesh.vertices[v] - point)) <= tolerance.offset; });
}

Face Summarize(const mesh::Mesh& mesh, std::vector<int> triangles) {
  std::sort(triangles.begin(), triangles.end());
  Face face{Vector3d::Zero(), Vector3d::Zero(), 0, std::move(triangles)};
  for (const int t : face.triangles) {
    const auto& v = mesh.triangles[t];
    const Vector3d normal = mesh.AreaNormal(v) / 2;
    face.normal += normal;
    face.centroid += normal.norm() * (mesh.vertices[v[0]] + mesh.vertices[v[1]] + mesh.vertices[v[2]]) / 3;
    face.area += normal.norm();
  }
  face.normal.normalize();
  face.centroid /= face.area;
  return face;
}

}  // namespace

std::vector<Face> MergeCoplanar(const mesh::Mesh& mesh, const FaceTolerance& tolerance,
                                std::vector<int>& face_of_triangle) {
  const EdgeMap edges = MakeEdgeMap(mesh);
  std::vector<int> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> size(mesh.triangles.size());
  for (std::size_t t = 0; t < size.size(); ++t) size[t] = mesh.AreaNormal(mesh.triangles[t]).norm();
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size[a] > size[b]; });

  std::vector<Face> faces;
  face_of_triangle.assign(mesh.triangles.size(), -1);
  for (const int seed : order) {
    if (face_of_triangle[seed] >= 0) continue;
    const int id = static_cast<int>(faces.size());
    const Vector3d normal = mesh.AreaNormal(mesh.triangles[seed]).normalized();
    const Vector3d point = mesh.vertices[mesh.triangles[seed][0]];
    std::vector<int> grown{seed};
    face_of_triangle[seed] = id;
    for (std::size_t i = 0; i < grown.size(); ++i) {
      const auto v = mesh.triangles[grown[i]];
      for (int k = 0; k < 3; ++k) {
        for (const int next : edges.at(MakeEdgeKey(v[k], v[(k + 1) % 3]))) {
          if (face_of_triangle[next] >= 0 || !LiesIn(mesh, next, normal, point, tolerance)) continue;
          face_of_triangle[next] = id;
          grown.push_back(next);
        }
      }
    }
    faces.push_back(Summarize(mesh, std::move(grown)));
  }
  return faces;
}

}  // namespace wirepose::tools
