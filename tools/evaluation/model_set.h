// The objects that an evaluation searches for.
#ifndef WIREPOSE_TOOLS_EVALUATION_MODEL_SET_H_
#define WIREPOSE_TOOLS_EVALUATION_MODEL_SET_H_

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "model/model_view.h"
#include "tools/model_compiler/model_compiler.h"

namespace wirepose::evaluation {

// Owns the model files' bytes; its views are valid as long as it lives.
struct ModelSet {
  std::vector<tools::CompiledModel> files;
  std::vector<ModelView> views;  // by rising id

  // Null if there is none.
  [[nodiscard]] const ModelView* Find(std::uint32_t id) const;
};

// With `models` a .wpm file or a folder of them, reads these; with an empty path compiles
// DATASET/models/obj_*.ply. `object_ids`: only these; empty: all. Error, one line: file, place,
// remedy; an id that no model has is one.
Result<ModelSet, std::string> LoadModelSet(const std::filesystem::path& dataset, const std::filesystem::path& models,
                                           const std::vector<int>& object_ids);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_MODEL_SET_H_
