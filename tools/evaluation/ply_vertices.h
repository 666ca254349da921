// The vertices of a PLY mesh: all that the pose errors need of a model.
#ifndef WIREPOSE_TOOLS_EVALUATION_PLY_VERTICES_H_
#define WIREPOSE_TOOLS_EVALUATION_PLY_VERTICES_H_

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "geometry/se3.h"

namespace wirepose::evaluation {

// Reads ASCII and binary little-endian PLY whose first element is `vertex`, unchanged and in the
// file's own unit: a mesh library might weld or reorder vertices, which would alter a maximum over
// them. Error: one line with the remedy.
Result<std::vector<Vector3d>, std::string> ReadPlyVertices(const std::filesystem::path& file);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_PLY_VERTICES_H_
