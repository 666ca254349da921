// A triangle mesh on its way from a file to a line model.
#ifndef WIREPOSE_MESH_MESH_H_
#define WIREPOSE_MESH_MESH_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace wirepose::mesh {

// Metres, model frame. Triangles are counter-clockwise seen from outside once OrientOutward has
// run.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;

  // Not normalised: twice the area, along the outward normal.
  [[nodiscard]] Eigen::Vector3d AreaNormal(const std::array<int, 3>& t) const {
    return (vertices[t[1]] - vertices[t[0]]).cross(vertices[t[2]] - vertices[t[0]]);
  }
};

}  // namespace wirepose::mesh

#endif  // WIREPOSE_MESH_MESH_H_
