// A picture of a line model for people.
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_WIREFRAME_DRAWING_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_WIREFRAME_DRAWING_H_

#include <filesystem>
#include <string>

#include "base/result.h"
#include "model/model_view.h"

namespace wirepose::tools {

// Draws the wireframe from a three-quarter view (front = -y, from the right and above) into a PNG:
// visible parts of edges black and solid, hidden parts grey and dashed, borders of open meshes red.
// The error names the file.
Result<void, std::string> DrawWireframe(const ModelView& model, const std::filesystem::path& png);

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_WIREFRAME_DRAWING_H_
