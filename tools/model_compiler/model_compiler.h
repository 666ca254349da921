// Mesh in, line model (.wpm) out.
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_MODEL_COMPILER_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_MODEL_COMPILER_H_

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "mesh/mesh.h"
#include "model/model_view.h"

namespace wirepose::tools {

enum class MeshUnit : std::uint8_t { kMillimetre, kMetre };

struct CompileOptions {
  std::uint32_t id = 1;                   // BOP object id
  std::string name;                       // 1..31 printable ASCII characters; empty: the mesh file's stem
  MeshUnit unit = MeshUnit::kMillimetre;  // of the mesh file; a Mesh in memory is in metres already
  double crease_angle_rad = 15.0 * 3.14159265358979323846 / 180.0;   // sharper edges between faces are lines
  double parallel_angle_rad = 1.0 * 3.14159265358979323846 / 180.0;  // up to here two model edges are parallel (eq. 1)
};

// A whole model file and what the compiler did to get there.
struct CompiledModel {
  std::vector<std::byte> bytes;    // aligned for ParseModel; moving the vector keeps views into it valid
  std::vector<std::string> notes;  // warnings for people, one line each: repairs, dropped edges, doubtful units

  // The parsed model; valid as long as `bytes`. Never fails on a model that CompileModel returned.
  [[nodiscard]] ModelView View() const;
};

// Reads a mesh (PLY, OBJ, STL and what else assimp reads) and compiles it. The error names file,
// problem and remedy. Same file and options, same bytes. Some seconds for the largest meshes: 162
// aspects are ray traced. Host only.
Result<CompiledModel, std::string> CompileModel(const std::filesystem::path& mesh_file, const CompileOptions& options);

// As above for a mesh in memory, in metres. `options.name` must be given. Errors do not name a
// file.
Result<CompiledModel, std::string> CompileModel(const mesh::Mesh& mesh, const CompileOptions& options);

// Reads a .wpm file whole, checked by ParseModel. The error names file, problem and remedy.
Result<CompiledModel, std::string> ReadModelFile(const std::filesystem::path& file);

// Writes the bytes; the error names the file.
Result<void, std::string> WriteModelFile(const std::filesystem::path& file, const CompiledModel& model);

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_MODEL_COMPILER_H_
