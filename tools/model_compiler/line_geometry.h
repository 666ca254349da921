// The wireframe of a mesh: its planar faces and the creases between them, before it becomes a model
// file.
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_LINE_GEOMETRY_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_LINE_GEOMETRY_H_

#include <Eigen/Core>
#include <array>
#include <vector>

#include "mesh/mesh.h"

namespace wirepose::tools {

inline constexpr int kOpen = -1;  // second face of an edge at the border of an open mesh

struct Face {
  Eigen::Vector3d normal;  // unit, outward, mean over the area
  Eigen::Vector3d centroid;
  double area = 0;  // m^2
  std::vector<int> triangles;
};

struct Crease {
  std::array<int, 2> vertex;
  std::array<int, 2> face;  // face[0] < face[1], or face[1] == kOpen
  double length = 0;        // m
  double dihedral = 0;      // rad, between the outward normals; 0 at a border
  bool convex = true;
};

struct FaceTolerance {
  double angle_rad;  // between a triangle and its face
  double offset;     // m, of a triangle's vertices from the plane of its face
};

// Grows planar faces over triangles that share an edge, from the largest triangle on. Each triangle
// gets one face. `face_of_triangle` receives its index. O(n log n).
std::vector<Face> MergeCoplanar(const mesh::Mesh& mesh, const FaceTolerance& tolerance,
                                std::vector<int>& face_of_triangle);

// Straight edges between two faces that meet at more than `crease_angle_rad`, and borders of open
// meshes. Collinear pieces between the same two faces become one. Where more than two faces meet,
// the two with the largest angle count. By falling length, then by vertices. `tolerance` [m]:
// within it points coincide.
std::vector<Crease> FindCreases(const mesh::Mesh& mesh, const std::vector<Face>& faces,
                                const std::vector<int>& face_of_triangle, double crease_angle_rad, double tolerance);

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_LINE_GEOMETRY_H_
