#include "app/command_handler.h"

namespace wirepose::app {
namespace {

// Smaller regions hold no line of the least length (SegmentParams) and would only hide a mistake in units.
constexpr int kMinRegion_px = 16;

}  // namespace

CommandAnswer CommandHandler::Execute(const Command& command) {
  CommandAnswer answer;
  answer.command = command;
  const std::string refusal = Apply(command);
  answer.accepted = refusal.empty();
  answer.reason = refusal;
  answer.paused = paused_;
  answer.searched_ids = models_.searched_ids();
  answer.region = recognizer_.region();
  return answer;
}

std::string CommandHandler::Apply(const Command& command) {
  switch (command.action) {
    case CommandAction::kSelectModels:
      return models_.Select(command.model_ids);
    case CommandAction::kSetRegion:
      return SetRegion(command.region);
    case CommandAction::kPause:
      paused_ = true;
      return "";
    case CommandAction::kResume:
      paused_ = false;
      return "";
    case CommandAction::kReloadModels:
      return models_.Reload();
  }
  return "no action " + std::to_string(static_cast<int>(command.action)) + "; see wirepose.idl for those that exist";
}

std::string CommandHandler::SetRegion(const ImageRegion& region) {
  const int right = region.x + region.width;
  const int bottom = region.y + region.height;
  if (!(region == ImageRegion{})) {
    const std::string image = std::to_string(image_width_) + "x" + std::to_string(image_height_);
    if (right > image_width_ || bottom > image_height_) return "the region reaches beyond the image of " + image;
    if (region.width < kMinRegion_px || region.height < kMinRegion_px) {
      return "the region is smaller than 16x16; all zeros stand for the whole image";
    }
  }
  recognizer_.SetRegion(region);
  return "";
}

}  // namespace wirepose::app
