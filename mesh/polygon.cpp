#include "mesh/polygon.h"

#include <algorithm>

namespace wirepose::mesh {
namespace {

using Eigen::Vector3d;

Vector3d NewellNormal(const Mesh& mesh, const std::vector<int>& polygon) {
  Vector3d normal = Vector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d origin = mesh.vertices[polygon[0]];
    normal += (mesh.vertices[polygon[i]] - origin).cross(mesh.vertices[polygon[(i + 1) % polygon.size()]] - origin);
  }
  return normal;
}

// Corner `at` of the polygon is an ear when it is convex and no other corner lies in its triangle.
bool IsEar(const Mesh& mesh, const std::vector<int>& polygon, std::size_t at, const Vector3d& normal) {
  const std::size_t n = polygon.size();
  const std::array<int, 3> ear{polygon[(at + n - 1) % n], polygon[at], polygon[(at + 1) % n]};
  if (mesh.AreaNormal(ear).dot(normal) <= 0) return false;
  return std::none_of(polygon.begin(), polygon.end(), [&](int v) {
    const Vector3d& p = mesh.vertices[v];
    for (int k = 0; k < 3; ++k) {
      const Vector3d &a = mesh.vertices[ear[k]], &b = mesh.vertices[ear[(k + 1) % 3]];
      if (p == a || (b - a).cross(p - a).dot(normal) < 0) return false;
    }
    return true;
  });
}

}  // namespace

void AppendPolygon(const std::vector<int>& polygon, Mesh& mesh) {
  std::vector<int> rest = polygon;
  const Vector3d normal = NewellNormal(mesh, polygon);
  while (rest.size() > 3) {
    std::size_t at = 0;
    while (at < rest.size() && !IsEar(mesh, rest, at, normal)) ++at;
    if (at == rest.size()) at = 0;  // crosses itself or has no area: any corner will do
    const std::size_t n = rest.size();
    mesh.triangles.push_back({rest[(at + n - 1) % n], rest[at], rest[(at + 1) % n]});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(at));
  }
  mesh.triangles.push_back({rest[0], rest[1], rest[2]});
}

}  // namespace wirepose::mesh
