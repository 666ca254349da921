// wirepose/command and wirepose/command_status.
#include "publish/message_parts.h"
#include "publish/messages.h"

namespace wirepose {
namespace {

static_assert(static_cast<int>(CommandAction::kSelectModels) == wirepose_SELECT_MODELS &&
              static_cast<int>(CommandAction::kSetRegion) == wirepose_SET_REGION &&
              static_cast<int>(CommandAction::kPause) == wirepose_PAUSE &&
              static_cast<int>(CommandAction::kResume) == wirepose_RESUME &&
              static_cast<int>(CommandAction::kReloadModels) == wirepose_RELOAD_MODELS);

}  // namespace

CommandMessage::CommandMessage() { Attach(value.model_ids, model_ids_); }

CommandStatusMessage::CommandStatusMessage() { Attach(value.searched_ids, searched_ids_); }

void FillMessage(const CommandAnswer& answer, CommandStatusMessage& message) {
  wirepose_CommandStatus& out = message.value;
  CopyText(answer.command.sender, out.sender);
  out.request_id = answer.command.request_id;
  out.action = static_cast<std::uint8_t>(answer.command.action);
  out.accepted = answer.accepted;
  CopyText(answer.reason, out.reason);
  out.paused = answer.paused;
  out.searched_ids._length = 0;
  for (const std::uint32_t id : answer.searched_ids) out.searched_ids._buffer[out.searched_ids._length++] = id;
  out.region = {answer.region.x, answer.region.y, answer.region.width, answer.region.height};
}

Command ReadMessage(const wirepose_Command& message) {
  Command command;
  command.sender = std::string_view(message.sender);
  command.request_id = message.request_id;
  command.action = static_cast<CommandAction>(message.action);
  // DDS has checked the length against the bound, which is ours.
  for (std::uint32_t i = 0; i < message.model_ids._length; ++i) {
    (void)command.model_ids.try_push_back(message.model_ids._buffer[i]);
  }
  command.region = {message.region.x_px, message.region.y_px, message.region.width_px, message.region.height_px};
  return command;
}

}  // namespace wirepose
