#include "app/model_library.h"

#include <algorithm>

#include "app/failure.h"
#include "base/check.h"

namespace wirepose::app {
namespace {

// What Recognizer::AddModel would refuse, said with the file's name and before anything has changed.
void RefuseDuplicates(const ModelStore& store) {
  const auto models = store.models();
  for (std::size_t i = 0; i < models.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (models[i].id != models[j].id) continue;
      throw WorkFailed(store.file(i).string() + ": id " + std::to_string(models[i].id) + ": " +
                       Describe(RecognizerError::kDuplicateModel));
    }
  }
}

}  // namespace

void ModelLibrary::Load(std::vector<std::filesystem::path> paths) {
  paths_ = std::move(paths);
  ModelStore& store = stores_[current_];
  store.Load(paths_);
  try {
    RefuseDuplicates(store);
  } catch (...) {
    store.Clear();
    throw;
  }
  Give(store);
}

std::uint32_t ModelLibrary::BitsOf(const ModelStore& store, const ModelIds& ids, std::string& refusal) {
  const auto models = store.models();
  // In 64 bits, since 32 models take all of 32.
  if (ids.empty()) return static_cast<std::uint32_t>((std::uint64_t{1} << models.size()) - 1);
  std::uint32_t bits = 0;
  for (const std::uint32_t id : ids) {
    const auto found = std::find_if(models.begin(), models.end(), [id](const ModelView& m) { return m.id == id; });
    if (found == models.end()) {
      refusal = "no model file has the id " + std::to_string(id) + "; see `wirepose model show`";
      return 0;
    }
    bits |= std::uint32_t{1} << (found - models.begin());
  }
  return bits;
}

std::string ModelLibrary::Select(const ModelIds& ids) {
  std::string refusal;
  const std::uint32_t bits = BitsOf(stores_[current_], ids, refusal);
  if (!refusal.empty()) return refusal;
  selected_ = ids;
  recognizer_.SearchFor(bits);
  return "";
}

std::string ModelLibrary::Reload() {
  ModelStore& fresh = stores_[1 - current_];
  std::string refusal;
  std::uint32_t bits = 0;
  try {
    fresh.Load(paths_);
    RefuseDuplicates(fresh);
    bits = BitsOf(fresh, selected_, refusal);
  } catch (const WorkFailed& e) {
    refusal = e.what();
  }
  if (!refusal.empty()) {
    fresh.Clear();
    return refusal;
  }
  Give(fresh);
  recognizer_.SearchFor(bits);
  stores_[current_].Clear();
  current_ = 1 - current_;
  return "";
}

ModelIds ModelLibrary::searched_ids() const {
  ModelIds ids;
  for (std::size_t i = 0; i < recognizer_.models().size(); ++i) {
    if (((recognizer_.searched() >> i) & 1U) != 0) ids.push_back(recognizer_.models()[i].id);
  }
  return ids;
}

// The store has refused what the recognizer would.
void ModelLibrary::Give(const ModelStore& store) {
  recognizer_.ClearModels();
  for (const ModelView& model : store.models()) Check(recognizer_.AddModel(model) == RecognizerError::kOk);
}

}  // namespace wirepose::app
