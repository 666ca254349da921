// Triangle meshes in metres: loaded, or made.
#ifndef WIREPOSE_SIM_MESH_H_
#define WIREPOSE_SIM_MESH_H_

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "geometry/se3.h"

namespace wirepose::sim {

struct Mesh {
  std::vector<Vector3> vertices;                        // m
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices into `vertices`; shaded flat

  // Corners of the axis-aligned bounding box. The mesh must not be empty.
  [[nodiscard]] Vector3 Min() const;
  [[nodiscard]] Vector3 Max() const;
};

// Reads PLY, OBJ, STL and whatever else assimp does; polygons become triangles. `unit_m`: length of
// the file's unit. The error is one line: "file: what; remedy".
[[nodiscard]] Result<Mesh, std::string> LoadMesh(const std::filesystem::path& path, double unit_m = 0.001);

// Centred at the origin, faces outwards.
[[nodiscard]] Mesh MakeBox(const Vector3& size);
// Axis z, centred at the origin; `sides` >= 3 flat side faces.
[[nodiscard]] Mesh MakeCylinder(float radius, float height, int sides);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_MESH_H_
