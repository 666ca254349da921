#include "app/model_store.h"

#include <algorithm>
#include <fstream>

#include "app/failure.h"
#include "base/check.h"

namespace wirepose::app {
namespace fs = std::filesystem;
namespace {

// The .wpm files of a folder by name, or the file itself.
std::vector<fs::path> Expand(const fs::path& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) return {path};
  if (!fs::is_directory(path, error)) {
    throw WorkFailed(path.string() + ": no such model file or folder; build one with `wirepose model build`");
  }
  std::vector<fs::path> files;
  for (fs::directory_iterator i(path, error), end; !error && i != end; i.increment(error)) {
    if (i->path().extension() == ".wpm") files.push_back(i->path());
  }
  if (error) throw WorkFailed(path.string() + ": cannot be read: " + error.message());
  if (files.empty()) {
    throw WorkFailed(path.string() + ": holds no .wpm file; build one with `wirepose model build`");
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

void ModelStore::Load(std::span<const fs::path> paths) {
  Clear();
  try {
    for (const fs::path& path : paths) {
      for (const fs::path& file : Expand(path)) LoadFile(file);
    }
  } catch (...) {
    Clear();
    throw;
  }
}

void ModelStore::Clear() {
  models_.clear();
  files_.clear();
  for (void* const block : blocks_) Check(pool_.Free(block) == PoolStatus::kOk);
  blocks_.clear();
}

void ModelStore::LoadFile(const fs::path& file) {
  void* const block = pool_.Alloc();
  if (block == nullptr) {
    throw WorkFailed(file.string() + ": one model too many; at most " + std::to_string(kMaxModels) +
                     " fit, remove some");
  }
  blocks_.push_back(block);
  const Result<ModelView, ModelError> model = ParseModel(ReadInto(file, block));
  if (!model) throw WorkFailed(file.string() + ": " + Describe(model.error()));
  models_.push_back(*model);
  files_.push_back(file);
}

std::span<std::byte> ModelStore::ReadInto(const fs::path& file, void* block) const {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) throw WorkFailed(file.string() + ": cannot be read: " + error.message());
  if (size > pool_.block_size()) {
    throw WorkFailed(file.string() + ": larger than any model can be (" + std::to_string(pool_.block_size()) +
                     " bytes); this is no model file");
  }
  std::ifstream in(file, std::ios::binary);
  in.read(static_cast<char*>(block), static_cast<std::streamsize>(size));
  if (!in) throw WorkFailed(file.string() + ": cannot be read; check its permissions");
  return {static_cast<std::byte*>(block), static_cast<std::size_t>(size)};
}

}  // namespace wirepose::app
