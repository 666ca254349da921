// Mesh files: PLY by our own reader, every other format by assimp.
#ifndef WIREPOSE_MESH_MESH_READER_H_
#define WIREPOSE_MESH_MESH_READER_H_

#include <filesystem>
#include <string>

#include "base/result.h"
#include "mesh/mesh.h"

namespace wirepose::mesh {

// All triangles of the file (polygons are split, scene nodes applied), coordinates times
// `metres_per_unit`. As written: vertices may be repeated, triangles degenerate or wound either
// way; see tools/model_compiler/mesh_cleaning.h. The error names file, problem and remedy.
Result<Mesh, std::string> ReadMesh(const std::filesystem::path& file, double metres_per_unit);

}  // namespace wirepose::mesh

#endif  // WIREPOSE_MESH_MESH_READER_H_
