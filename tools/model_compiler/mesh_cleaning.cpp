#include "tools/model_compiler/mesh_cleaning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <vector>

#include "tools/model_compiler/edge_map.h"

namespace wirepose::tools {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

bool Less(const Vector3d& a, const Vector3d& b) {
  return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z());
}

// Points in cubes of the tolerance's size, so that near ones are found in 27 cubes.
class PointGrid {
 public:
  explicit PointGrid(double tolerance) : tolerance_(tolerance) {}

  // The index of a known point nearer than the tolerance, or of `p`, which is then new.
  int FindOrAdd(const Vector3d& p, std::vector<Vector3d>& points) {
    const Cell home = CellOf(p);
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        for (std::int64_t dz = -1; dz <= 1; ++dz) {
          const auto it = cells_.find({home[0] + dx, home[1] + dy, home[2] + dz});
          if (it == cells_.end()) continue;
          for (const int i : it->second) {
            if ((points[i] - p).norm() <= tolerance_) return i;
          }
        }
      }
    }
    points.push_back(p);
    cells_[home].push_back(static_cast<int>(points.size()) - 1);
    return static_cast<int>(points.size()) - 1;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] Cell CellOf(const Vector3d& p) const {
    return {std::llround(p.x() / tolerance_), std::llround(p.y() / tolerance_), std::llround(p.z() / tolerance_)};
  }
  double tolerance_;
  std::map<Cell, std::vector<int>> cells_;
};

bool IsDegenerate(const mesh::Mesh& mesh, const Triangle& t, double tolerance) {
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, (mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]]).norm());
  return mesh.AreaNormal(t).norm() <= tolerance * longest;  // height over the longest side
}

// Smallest index first; the sense of rotation stays.
Triangle Canonical(const Triangle& t) {
  const auto first = std::min_element(t.begin(), t.end()) - t.begin();
  return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}

void DropUnusedVertices(mesh::Mesh& mesh) {
  std::vector<int> new_index(mesh.vertices.size(), -1);
  for (const Triangle& t : mesh.triangles) {
    for (const int v : t) new_index[v] = 0;
  }
  std::vector<Vector3d> kept;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (new_index[i] < 0) continue;
    new_index[i] = static_cast<int>(kept.size());
    kept.push_back(mesh.vertices[i]);
  }
  mesh.vertices = std::move(kept);
  for (Triangle& t : mesh.triangles) {
    for (int& v : t) v = new_index[v];
  }
}

// Does triangle `t` run along the edge from `a` to `b`, in this direction?
bool RunsAlong(const Triangle& t, int a, int b) {
  for (int k = 0; k < 3; ++k) {
    if (t[k] == a && t[(k + 1) % 3] == b) return true;
  }
  return false;
}

double SignedVolume(const mesh::Mesh& mesh, const std::vector<int>& component, const Vector3d& origin) {
  double volume = 0;
  for (const int t : component) {
    const Triangle& v = mesh.triangles[t];
    volume += (mesh.vertices[v[0]] - origin).dot(mesh.AreaNormal(v)) / 6;
  }
  return volume;
}

// Flood-fills from `seed` over edges with two triangles; `turn[t]` says whether t must be turned to
// agree with the seed.
std::vector<int> CollectComponent(const mesh::Mesh& mesh, const EdgeMap& edges, int seed, std::vector<int>& turn) {
  std::vector<int> component{seed};
  turn[seed] = 0;
  for (std::size_t i = 0; i < component.size(); ++i) {
    const int t = component[i];
    const Triangle& v = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const int a = v[k], b = v[(k + 1) % 3];
      const std::vector<int>& sharing = edges.at(MakeEdgeKey(a, b));
      if (sharing.size() != 2) continue;
      const int other = sharing[0] == t ? sharing[1] : sharing[0];
      if (turn[other] >= 0) continue;
      turn[other] = RunsAlong(mesh.triangles[other], a, b) ? 1 - turn[t] : turn[t];
      component.push_back(other);
    }
  }
  return component;
}

std::size_t TurnTriangles(const std::vector<int>& component, const std::vector<int>& turn, mesh::Mesh& mesh) {
  std::size_t turned = 0;
  for (const int t : component) {
    if (turn[t] == 0) continue;
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    ++turned;
  }
  return turned;
}

// The vertex that lies inside the segment from a to b, nearest to a; -1 if none.
int VertexInside(const mesh::Mesh& mesh, const std::set<int>& candidates, int a, int b, double tolerance) {
  const Vector3d direction = mesh.vertices[b] - mesh.vertices[a];
  const double length = direction.norm();
  int best = -1;
  double best_along = length;
  for (const int v : candidates) {
    const Vector3d offset = mesh.vertices[v] - mesh.vertices[a];
    const double along = offset.dot(direction) / length;
    if (along <= tolerance || along >= length - tolerance || along >= best_along) continue;
    if ((offset - direction * (along / length)).norm() > tolerance) continue;
    best = v;
    best_along = along;
  }
  return best;
}

}  // namespace

double Diameter(const mesh::Mesh& mesh) {
  double squared = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (std::size_t j = i + 1; j < mesh.vertices.size(); ++j) {
      squared = std::max(squared, (mesh.vertices[i] - mesh.vertices[j]).squaredNorm());
    }
  }
  return std::sqrt(squared);
}

double BoxDiagonal(const mesh::Mesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  Vector3d low = mesh.vertices[0], high = low;
  for (const Vector3d& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return (high - low).norm();
}

std::size_t Weld(double tolerance, mesh::Mesh& mesh) {
  // Sorted first, so that the representative of a cluster does not depend on the file's order.
  std::vector<int> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return Less(mesh.vertices[a], mesh.vertices[b]); });
  std::vector<Vector3d> welded;
  std::vector<int> new_index(mesh.vertices.size());
  PointGrid grid(tolerance);
  for (const int i : order) new_index[i] = grid.FindOrAdd(mesh.vertices[i], welded);
  mesh.vertices = std::move(welded);

  const std::size_t before = mesh.triangles.size();
  std::vector<Triangle> kept;
  for (const Triangle& t : mesh.triangles) {
    const Triangle w{new_index[t[0]], new_index[t[1]], new_index[t[2]]};
    if (!IsDegenerate(mesh, w, tolerance)) kept.push_back(Canonical(w));
  }
  std::sort(kept.begin(), kept.end());
  std::set<Triangle> seen;
  mesh.triangles.clear();
  for (const Triangle& t : kept) {
    Triangle corners = t;
    std::sort(corners.begin(), corners.end());
    if (seen.insert(corners).second) mesh.triangles.push_back(t);
  }
  DropUnusedVertices(mesh);
  return before - mesh.triangles.size();
}

std::size_t SplitAtTJunctions(double tolerance, mesh::Mesh& mesh) {
  std::size_t splits = 0;
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<std::pair<EdgeKey, int>> open;
    std::set<int> candidates;
    for (const auto& [edge, triangles] : MakeEdgeMap(mesh)) {
      if (triangles.size() != 1) continue;
      open.emplace_back(edge, triangles[0]);
      candidates.insert({edge.first, edge.second});
    }
    std::set<int> touched;  // each triangle at most once a round: its edges change
    for (const auto& [edge, t] : open) {
      if (touched.contains(t)) continue;
      const int v = VertexInside(mesh, candidates, edge.first, edge.second, tolerance);
      Triangle& old = mesh.triangles[t];
      if (v < 0 || std::find(old.begin(), old.end(), v) != old.end()) continue;
      Triangle first = old, second = old;
      std::replace(first.begin(), first.end(), edge.second, v);
      std::replace(second.begin(), second.end(), edge.first, v);
      old = first;
      mesh.triangles.push_back(second);
      touched.insert(t);
      ++splits;
      changed = true;
    }
  }
  return splits;
}

std::size_t OrientOutward(mesh::Mesh& mesh) {
  const EdgeMap edges = MakeEdgeMap(mesh);
  std::vector<int> turn(mesh.triangles.size(), -1);
  std::size_t turned = 0;
  for (int seed = 0; seed < static_cast<int>(mesh.triangles.size()); ++seed) {
    if (turn[seed] >= 0) continue;
    const std::vector<int> component = CollectComponent(mesh, edges, seed, turn);
    const auto minority = std::count_if(component.begin(), component.end(), [&](int t) { return turn[t] == 1; });
    if (2 * minority > static_cast<std::ptrdiff_t>(component.size())) {
      for (const int t : component) turn[t] = 1 - turn[t];
    }
    turned += TurnTriangles(component, turn, mesh);

    // Of an open shell the volume depends on the origin; its centre of area is the fair choice.
    Vector3d centre = Vector3d::Zero();
    double area = 0, extent = 0;
    for (const int t : component) {
      const Triangle& v = mesh.triangles[t];
      const double a = mesh.AreaNormal(v).norm();
      centre += a * (mesh.vertices[v[0]] + mesh.vertices[v[1]] + mesh.vertices[v[2]]) / 3;
      area += a;
    }
    centre /= area;
    for (const int t : component) extent = std::max(extent, (mesh.vertices[mesh.triangles[t][0]] - centre).norm());
    if (SignedVolume(mesh, component, centre) < -1e-6 * area * extent) {
      for (const int t : component) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      turned += component.size();
    }
  }
  return turned;
}

}  // namespace wirepose::tools
