// The models that the recognizer knows, and which of them it searches for; both can change while the program runs.
#ifndef WIREPOSE_APP_MODEL_LIBRARY_H_
#define WIREPOSE_APP_MODEL_LIBRARY_H_

#include <filesystem>
#include <string>
#include <vector>

#include "app/model_store.h"
#include "pipeline/recognizer.h"
#include "publish/commands.h"

namespace wirepose::app {

// Owns the model files' bytes: make it static. Two stores, so that the models in use stay until new ones are known to be
// good. Not thread safe; call on the recognizer's thread.
class ModelLibrary {
 public:
  explicit ModelLibrary(Recognizer& recognizer) : recognizer_(recognizer) {}

  // Loads `paths` and gives all models to the recognizer. Throws WorkFailed with file and reason; then nothing is loaded.
  void Load(std::vector<std::filesystem::path> paths);

  // The following return why they refuse, and then have changed nothing; empty: done.

  // Searches for these ids from the next frame on; for all that are loaded when empty.
  std::string Select(const ModelIds& ids);
  // Reads the files again; models that were added to a folder come with it. A selection stays.
  std::string Reload();

  [[nodiscard]] ModelIds searched_ids() const;
  // Bit i: models()[i] is searched for.
  [[nodiscard]] std::uint32_t searched() const { return recognizer_.searched(); }

 private:
  // Which models of the store `ids` chooses; 0 and a reason when one is missing.
  static std::uint32_t BitsOf(const ModelStore& store, const ModelIds& ids, std::string& refusal);
  void Give(const ModelStore& store);

  Recognizer& recognizer_;
  std::vector<std::filesystem::path> paths_;
  ModelStore stores_[2];
  int current_ = 0;
  ModelIds selected_;  // empty: all
};

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_MODEL_LIBRARY_H_
