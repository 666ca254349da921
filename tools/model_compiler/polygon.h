// Polygons to triangles.
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_POLYGON_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_POLYGON_H_

#include <vector>

#include "tools/model_compiler/mesh.h"

namespace wirepose::tools {

// Splits a nearly planar simple polygon (indices into mesh.vertices, at least 3, convex or not) by
// ear clipping and appends the triangles, which keep its sense of rotation. A polygon that crosses
// itself yields some triangles, not an error. O(n^3) at worst.
void AppendPolygon(const std::vector<int>& polygon, Mesh& mesh);

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_POLYGON_H_
