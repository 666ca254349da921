// The Stanford PLY format, read by ourselves: assimp 5.2 hangs or crashes on truncated PLY files.
#ifndef WIREPOSE_MESH_PLY_READER_H_
#define WIREPOSE_MESH_PLY_READER_H_

#include <string>
#include <string_view>

#include "base/result.h"
#include "mesh/mesh.h"

namespace wirepose::mesh {

// The polygons of a PLY file (format 1.0: ascii, binary_little_endian or binary_big_endian) as
// triangles, coordinates times `metres_per_unit`. Elements and properties beside vertex x y z and
// face vertex_indices (or vertex_index) are skipped. Any bytes are safe. The error says what is
// wrong, where (line, or which record of which element) and what to do.
Result<Mesh, std::string> ParsePly(std::string_view file, double metres_per_unit);

}  // namespace wirepose::mesh

#endif  // WIREPOSE_MESH_PLY_READER_H_
