// The model's line sets and their parameter vectors (paper section 3.1, equations 1-7).
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_LINE_SETS_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_LINE_SETS_H_

#include <vector>

#include "model/model_format.h"
#include "tools/model_compiler/line_geometry.h"

namespace wirepose::tools {

struct LineSets {
  std::vector<ModelLineSet> sets;
  std::vector<ModelSetMember> members;
};

// The parameter vector of the pair (base, member). lambda of lines within `parallel_angle_rad` is
// the distance of the member's middle from the base line, of others that of the common
// perpendicular.
ModelSetMember ParameterVector(const mesh::Mesh& mesh, const std::vector<Crease>& creases, int base, int member,
                               double parallel_angle_rad);

// For each of the longest kMaxLineSetEdges creases that an aspect shows, a parallel and an
// intersecting set over the others of them that some aspect shows together with it; empty sets are
// left out. Creases come by falling length. `co_visible[i][j]` says that some aspect shows both i
// and j, `co_visible[i][i]` that some aspect shows i. An intersecting set also holds lines without
// a common corner: their true end-point distance is in the vector, and delta_d (eq. 5) stays a
// matter of matching. Members come by rising end-point distance, so corners come first.
LineSets MakeLineSets(const mesh::Mesh& mesh, const std::vector<Crease>& creases,
                      const std::vector<std::vector<bool>>& co_visible, double parallel_angle_rad);

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_LINE_SETS_H_
