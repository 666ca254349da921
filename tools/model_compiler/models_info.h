// models_info.json of the BOP data set format.
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_MODELS_INFO_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_MODELS_INFO_H_

#include <filesystem>
#include <span>
#include <string>

#include "base/result.h"
#include "model/model_view.h"

namespace wirepose::tools {

// Diameter, bounding box and discrete symmetries of each model by id, lengths in millimetres,
// symmetries as row-major 4x4 matrices without the identity. Replaces the file. The error names the
// file.
Result<void, std::string> WriteModelsInfo(const std::filesystem::path& file, std::span<const ModelView> models);

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_MODELS_INFO_H_
