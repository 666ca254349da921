// Polygons to triangles.
#ifndef WIREPOSE_MESH_POLYGON_H_
#define WIREPOSE_MESH_POLYGON_H_

#include <vector>

#include "mesh/mesh.h"

namespace wirepose::mesh {

// Splits a nearly planar simple polygon (indices into mesh.vertices, at least 3, convex or not) by
// ear clipping and appends the triangles, which keep its sense of rotation. A polygon that crosses
// itself yields some triangles, not an error. O(n^3) at worst.
void AppendPolygon(const std::vector<int>& polygon, Mesh& mesh);

}  // namespace wirepose::mesh

#endif  // WIREPOSE_MESH_POLYGON_H_
