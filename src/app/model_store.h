// The model files in memory whose size is fixed.
#ifndef WIREPOSE_APP_MODEL_STORE_H_
#define WIREPOSE_APP_MODEL_STORE_H_

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/fixed_vector.h"
#include "base/memory_pool.h"
#include "capacities.h"
#include "model/model_parser.h"

namespace wirepose::app {

// The largest model file that the capacities allow: every section full and padded to its alignment.
inline constexpr std::size_t kMaxModelFileBytes =
    sizeof(ModelFileHeader) + kMaxModelVertices * sizeof(ModelVertex) + kMaxModelTriangles * sizeof(ModelTriangle) +
    kMaxModelFaces * sizeof(ModelFace) + kMaxModelEdges * sizeof(ModelEdge) + kMaxModelLineSets * sizeof(ModelLineSet) +
    kMaxModelSetMembers * sizeof(ModelSetMember) + kMaxModelSymmetries * sizeof(ModelSymmetry) +
    kMaxModelAspects * sizeof(ModelAspect) + 9 * kModelAlignment;

// Owns the bytes behind the models: make it static and let it outlive the recognizer's use of them.
// Not thread safe.
class ModelStore {
 public:
  // Loads each path: a .wpm file, or a folder with all its .wpm files by name. Throws WorkFailed
  // with file and reason; then the store is empty.
  void Load(std::span<const std::filesystem::path> paths);
  void Clear();

  [[nodiscard]] std::span<const ModelView> models() const { return models_; }
  // The file that models()[i] came from.
  [[nodiscard]] const std::filesystem::path& file(std::size_t i) const { return files_[i]; }

 private:
  void LoadFile(const std::filesystem::path& file);
  std::span<std::byte> ReadInto(const std::filesystem::path& file, void* block) const;

  StaticMemoryPool<kMaxModelFileBytes, kMaxModels> pool_;
  FixedVector<void*, kMaxModels> blocks_;
  FixedVector<ModelView, kMaxModels> models_;
  std::vector<std::filesystem::path> files_;
};

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_MODEL_STORE_H_
