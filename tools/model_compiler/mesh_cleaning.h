// Repairs that make a mesh from any source fit for face and edge extraction. Run in the order of
// this header.
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_MESH_CLEANING_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_MESH_CLEANING_H_

#include <cstddef>

#include "mesh/mesh.h"

namespace wirepose::tools {

// Largest distance between two vertices. O(n^2): after the number of triangles has been checked.
double Diameter(const mesh::Mesh& mesh);

// Of the axis-aligned bounding box of all vertices. O(n).
double BoxDiagonal(const mesh::Mesh& mesh);

// Joins vertices nearer than `tolerance` [m], drops those that no triangle uses and those triangles
// that have become degenerate (thinner than the tolerance) or occur twice (either way round), and
// puts vertices and triangles into an order that does not depend on the file. Returns the number of
// triangles dropped. O(n log n).
std::size_t Weld(double tolerance, mesh::Mesh& mesh);

// Splits triangles at vertices that lie inside an edge which nothing else shares (T-junctions), so
// that neighbours become neighbours. Returns the number of splits. O(open edges * vertices on
// them).
std::size_t SplitAtTJunctions(double tolerance, mesh::Mesh& mesh);

// Gives the triangles of each connected component one sense of rotation, and closed or nearly
// closed ones the outward one (positive signed volume). Components meet where more than two
// triangles share an edge; there each keeps its own. A flat or open sheet without a clear inside
// keeps the sense of most of its triangles. Returns the number of triangles turned. O(n log n).
std::size_t OrientOutward(mesh::Mesh& mesh);

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_MESH_CLEANING_H_
