#include "sim/mesh.h"

#include <cmath>
#include <numbers>

#include "mesh/mesh_reader.h"

namespace wirepose::sim {

Vector3 Mesh::Min() const {
  Vector3 low = vertices.front();
  for (const Vector3& v : vertices) low = low.cwiseMin(v);
  return low;
}

Vector3 Mesh::Max() const {
  Vector3 high = vertices.front();
  for (const Vector3& v : vertices) high = high.cwiseMax(v);
  return high;
}

Result<Mesh, std::string> LoadMesh(const std::filesystem::path& path, double unit_m) {
  const Result<mesh::Mesh, std::string> file = mesh::ReadMesh(path, unit_m);
  if (!file) return unexpected(file.error());
  Mesh mesh;
  for (const Vector3d& vertex : file->vertices) {
    mesh.vertices.push_back(vertex.cast<float>());
    if (!mesh.vertices.back().allFinite()) {
      return unexpected(path.string() + ": vertex " + std::to_string(mesh.vertices.size() - 1) +
                        " is not finite; repair the mesh");
    }
  }
  for (const std::array<int, 3>& t : file->triangles) {
    mesh.triangles.push_back(
        {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]), static_cast<std::uint32_t>(t[2])});
  }
  return mesh;
}

Mesh MakeBox(const Vector3& size) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Vector3 corner((i & 1) != 0 ? 0.5F : -0.5F, (i & 2) != 0 ? 0.5F : -0.5F, (i & 4) != 0 ? 0.5F : -0.5F);
    mesh.vertices.push_back(corner.cwiseProduct(size));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

Mesh MakeCylinder(float radius, float height, int sides) {
  Mesh mesh;
  const auto count = static_cast<std::uint32_t>(sides);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    const float x = radius * static_cast<float>(std::cos(angle));
    const float y = radius * static_cast<float>(std::sin(angle));
    mesh.vertices.emplace_back(x, y, -height / 2);
    mesh.vertices.emplace_back(x, y, height / 2);
  }
  mesh.vertices.emplace_back(0.0F, 0.0F, -height / 2);
  mesh.vertices.emplace_back(0.0F, 0.0F, height / 2);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % count);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    mesh.triangles.push_back({2 * count, b, a});
    mesh.triangles.push_back({2 * count + 1, a + 1, b + 1});
  }
  return mesh;
}

}  // namespace wirepose::sim
