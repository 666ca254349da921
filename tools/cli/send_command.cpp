#include "send_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>

#include "bus_options.h"
#include "message_text.h"
#include "subscription.h"

namespace wirepose::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct SendOptions {
  BusOptions bus;
  bool json = false;
  double timeout_s = 10;
  std::vector<std::uint32_t> models;
  std::vector<std::uint16_t> region;
};

[[noreturn]] void FailForSilence(const SendOptions& options, const char* what) {
  throw WorkFailed(
      fmt::format("{} for {} s on {}; is wireposed running with the same domain, loopback setting and topic "
                  "names, and do its security permissions allow commands?",
                  what, options.timeout_s, Where(options.bus)));
}

// A recorder learns of this program when the robot does, within milliseconds, but not always before it. Who has not met
// the writer when the command goes out never hears it.
constexpr auto kQuiet = std::chrono::milliseconds(250);

// Both ways must be open before the command goes out, since the answer is not kept for who comes late; and no further
// listener has come for a while.
void WaitForListeners(dds_entity_t writer, const Subscription& answers, const SendOptions& options,
                      Clock::time_point end) {
  std::uint32_t listeners = 0;
  Clock::time_point changed = Clock::now();
  for (;;) {
    dds_publication_matched_status_t status{};
    if (dds_get_publication_matched_status(writer, &status) >= 0 && status.current_count != listeners) {
      listeners = status.current_count;
      changed = Clock::now();
    }
    const bool open = listeners > 0 && answers.Events().publishers > 0;
    if (open && Clock::now() - changed > kQuiet) return;
    if (Clock::now() > end) {
      if (open) return;
      FailForSilence(options, "no wireposed that takes commands");
    }
    dds_sleepfor(DDS_MSECS(5));
  }
}

void FillCommand(std::uint8_t action, const SendOptions& options, wirepose_Command& command) {
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  std::snprintf(command.sender, sizeof command.sender, "wirepose %d", static_cast<int>(getpid()));
  command.request_id = static_cast<std::uint64_t>(now);
  command.action = action;
  if (options.models.size() > command.model_ids._maximum) {
    throw UsageError(fmt::format("at most {} models", command.model_ids._maximum));
  }
  for (const std::uint32_t id : options.models) command.model_ids._buffer[command.model_ids._length++] = id;
  if (!options.region.empty()) {
    command.region = {options.region[0], options.region[1], options.region[2], options.region[3]};
  }
}

void Send(std::uint8_t action, const SendOptions& options) {
  const Clock::time_point end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.timeout_s));
  const Bus bus = OpenBus(options.bus);
  const Result<dds_entity_t, std::string> writer = bus.CreateWriter(TopicId::kCommand);
  if (!writer) throw WorkFailed(writer.error());
  TypedSubscription<CommandStatusMessage> answers(bus, TopicId::kCommandStatus);
  const auto command = std::make_unique<CommandMessage>();
  FillCommand(action, options, command->value);
  WaitForListeners(*writer, answers, options, end);
  if (dds_write(*writer, &command->value) < 0) throw WorkFailed("DDS refused the command; try again");
  for (;;) {
    while (answers.Take()) {
      const wirepose_CommandStatus& answer = answers.message();
      if (answer.request_id != command->value.request_id || std::strcmp(answer.sender, command->value.sender) != 0) {
        continue;
      }
      std::fputs((options.json ? ToJson(answer).dump() + "\n" : ToText(answer)).c_str(), stdout);
      if (!answer.accepted) throw WorkFailed(fmt::format("wireposed refused the command: {}", answer.reason));
      return;
    }
    if (Clock::now() > end) FailForSilence(options, "no answer");
    dds_sleepfor(DDS_MSECS(5));
  }
}

}  // namespace

void AddSendCommand(CLI::App& app) {
  const auto options = std::make_shared<SendOptions>();
  CLI::App* const command = app.add_subcommand("command", "tell a running wireposed what to do");
  command->require_subcommand(1);
  command->fallthrough();
  command->add_flag("--json", options->json, "the answer as a JSON object");
  command->add_option("--timeout", options->timeout_s, "fail after that many seconds without an answer")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  AddBusOptions(*command, options->bus);
  const auto add = [&](const char* name, const char* help, std::uint8_t action) {
    CLI::App* const sub = command->add_subcommand(name, help);
    sub->fallthrough();
    sub->callback([action, options] { Send(action, *options); });
    return sub;
  };
  add("select", "search for these models only; without ids for all that are loaded", wirepose_SELECT_MODELS)
      ->add_option("ids", options->models, "model ids");
  add("region", "look for objects in a part of the left image; without numbers in all of it", wirepose_SET_REGION)
      ->add_option("region", options->region, "x y width height, px")
      ->expected(4);
  add("pause", "take frames, but recognize nothing", wirepose_PAUSE);
  add("resume", "recognize again", wirepose_RESUME);
  add("reload", "read the model files again", wirepose_RELOAD_MODELS);
}

}  // namespace wirepose::cli
