// Executes what arrives on the command topic, between two frames.
#ifndef WIREPOSE_APP_COMMAND_HANDLER_H_
#define WIREPOSE_APP_COMMAND_HANDLER_H_

#include <string>

#include "app/model_library.h"
#include "pipeline/recognizer.h"
#include "publish/commands.h"

namespace wirepose::app {

// Holds what commands can change: which models are searched for, where, and whether at all. Call on the thread of the
// recognizer only.
class CommandHandler {
 public:
  // The recognizer is configured; both outlive the handler.
  CommandHandler(Recognizer& recognizer, ModelLibrary& models, int image_width, int image_height)
      : recognizer_(recognizer), models_(models), image_width_(image_width), image_height_(image_height) {}

  // Does all of it or nothing: a refused command changes nothing and the answer says why. O(1), but for kReloadModels,
  // which reads the model files and may take tens of milliseconds.
  CommandAnswer Execute(const Command& command);

  [[nodiscard]] bool paused() const { return paused_; }

 private:
  // Each returns why it refuses; empty when it has done it.
  std::string Apply(const Command& command);
  std::string SetRegion(const ImageRegion& region);

  Recognizer& recognizer_;
  ModelLibrary& models_;
  const int image_width_, image_height_;
  bool paused_ = false;
};

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_COMMAND_HANDLER_H_
