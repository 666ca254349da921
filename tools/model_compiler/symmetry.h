// Rotations that map an object onto itself.
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_SYMMETRY_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_SYMMETRY_H_

#include <cstddef>
#include <vector>

#include "geometry/se3.h"
#include "tools/model_compiler/line_geometry.h"

namespace wirepose::tools {

struct Symmetries {
  std::vector<Pose> poses;  // p -> R p + t, without the identity; with it they form a group
  std::size_t found = 0;    // more than poses.size() when the limit made us keep a subgroup
};

// All proper rotations that map every crease onto a crease and every face onto a face within
// `tolerance` [m], at most `capacity` of them. Of a larger group (a finely tessellated cylinder)
// the largest subgroup that fits and that one or two elements generate is kept. Shape only: what is
// printed on the object is not seen. O(creases^3) at worst.
Symmetries FindSymmetries(const mesh::Mesh& mesh, const std::vector<Face>& faces, const std::vector<Crease>& creases,
                          double tolerance, std::size_t capacity);

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_SYMMETRY_H_
