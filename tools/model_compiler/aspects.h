// Which edges can be seen from where.
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_ASPECTS_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_ASPECTS_H_

#include <Eigen/Core>
#include <vector>

#include "tools/model_compiler/line_geometry.h"

namespace wirepose::tools {

inline constexpr int kSamplesPerEdge = 16;
inline constexpr double kAspectDistance = 3;  // diameters from the centre of the bounding box

// What a camera at `direction` * `distance` from the centre of the bounding box sees.
struct Aspect {
  Eigen::Vector3d direction;         // unit, from the centre to the camera
  double distance = 0;               // m
  std::vector<int> visible_samples;  // for every crease: 0..kSamplesPerEdge
};

// The vertices of an icosahedron after `subdivisions`: 12, 42, 162 ... unit vectors, evenly spread.
std::vector<Eigen::Vector3d> SphereDirections(int subdivisions);

// Sample k of a crease: the middle of the k-th of kSamplesPerEdge equal pieces.
Eigen::Vector3d EdgeSample(const mesh::Mesh& mesh, const Crease& crease, int k);

// Traces rays from 162 cameras to samples on every crease. A sample is visible when nothing blocks
// the ray until `tolerance` [m] before it and a face beside the crease turns to the camera; borders
// of open meshes are visible from both sides. O(aspects * creases * samples * log triangles).
std::vector<Aspect> TraceAspects(const mesh::Mesh& mesh, const std::vector<Face>& faces,
                                 const std::vector<Crease>& creases, double diameter, double tolerance);

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_ASPECTS_H_
