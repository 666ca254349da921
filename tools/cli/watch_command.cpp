#include "watch_command.h"

#include <fmt/format.h>

#include <chrono>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "message_text.h"
#include "publish/bus.h"
#include "publish/messages.h"

namespace wirepose::cli {
namespace {

struct WatchOptions {
  std::string topic;  // empty: recognition and health
  bool once = false;
  bool json = false;
  bool loopback = false;
  std::uint64_t frames = 0;
  double timeout_s = 10;
  std::uint32_t domain = 0;
};

using Seconds = std::chrono::duration<double>;
using Clock = std::chrono::steady_clock;

void Print(const std::string& text) {
  std::cout << text << std::flush;
  if (!std::cout) throw WorkFailed("cannot write to standard output; is it a closed pipe?");
}

// One topic: a reader, and a message to take into.
class Subscription {
 public:
  virtual ~Subscription() = default;
  // Prints what has arrived, at most `limit` messages; returns how many.
  virtual std::uint64_t PrintNew(bool json, std::uint64_t limit) = 0;
  // Do messages of this topic count for --frames?
  bool counts = true;
};

template <typename Message>
class TopicSubscription final : public Subscription {
 public:
  TopicSubscription(const Bus& bus, const TopicSpec& topic) {
    const Result<dds_entity_t, std::string> reader = bus.CreateReader(topic);
    if (!reader) throw WorkFailed(reader.error());
    reader_ = *reader;
  }

  std::uint64_t PrintNew(bool json, std::uint64_t limit) override {
    std::uint64_t printed = 0;
    void* samples[] = {&message_->value};
    dds_sample_info_t info{};
    while (printed < limit && dds_take(reader_, samples, &info, 1, 1) > 0) {
      if (!info.valid_data) continue;  // only says that a writer has gone
      ++printed;
      // Text may come from another vendor's program: replace what is not UTF-8 instead of failing.
      Print(json ? ToJson(message_->value).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n"
                 : ToText(message_->value));
    }
    return printed;
  }

 private:
  dds_entity_t reader_ = 0;
  std::unique_ptr<Message> message_ = std::make_unique<Message>();
};

std::vector<std::unique_ptr<Subscription>> Subscribe(const Bus& bus, const std::string& topic) {
  std::vector<std::unique_ptr<Subscription>> subscriptions;
  if (topic == "detections") {
    subscriptions.push_back(std::make_unique<TopicSubscription<DetectionsMessage>>(bus, kDetectionsTopic));
  }
  if (topic.empty() || topic == "recognition") {
    subscriptions.push_back(std::make_unique<TopicSubscription<RecognitionMessage>>(bus, kRecognitionTopic));
  }
  if (topic.empty() || topic == "health") {
    subscriptions.push_back(std::make_unique<TopicSubscription<HealthMessage>>(bus, kHealthTopic));
    subscriptions.back()->counts = !topic.empty();
  }
  return subscriptions;
}

[[noreturn]] void FailForSilence(const WatchOptions& options) {
  throw WorkFailed(
      fmt::format("nothing arrived for {} s on DDS domain {}{}; is wireposed running with the same "
                  "domain and loopback setting?",
                  options.timeout_s, options.domain, options.loopback ? " (loopback)" : ""));
}

void Watch(const WatchOptions& options) {
  const Result<Bus, std::string> bus = Bus::Open({options.domain, options.loopback});
  if (!bus) throw WorkFailed(bus.error());
  const auto subscriptions = Subscribe(*bus, options.topic);
  const std::uint64_t wanted = options.once ? 1 : options.frames;  // 0: no end
  std::uint64_t counted = 0;
  Clock::time_point last = Clock::now();
  while (wanted == 0 || counted < wanted) {
    std::uint64_t printed = 0;
    for (const auto& subscription : subscriptions) {
      const bool limited = subscription->counts && wanted > 0;
      const std::uint64_t limit = limited ? wanted - counted : std::numeric_limits<std::uint64_t>::max();
      const std::uint64_t news = subscription->PrintNew(options.json, limit);
      printed += news;
      if (subscription->counts) counted += news;
    }
    const Clock::time_point now = Clock::now();
    if (printed > 0) last = now;
    if (options.timeout_s > 0 && Seconds(now - last).count() > options.timeout_s) FailForSilence(options);
    // A person or a test reads this: waking 200 times a second is soon enough and needs no wait
    // set.
    if (printed == 0) dds_sleepfor(DDS_MSECS(5));
  }
}

}  // namespace

void AddWatchCommand(CLI::App& app) {
  const auto options = std::make_shared<WatchOptions>();
  CLI::App* const command = app.add_subcommand("watch", "print what wireposed publishes, live");
  command->add_option("--topic", options->topic, "only this one; default: recognition and health")
      ->check(CLI::IsMember({"detections", "recognition", "health"}));
  command->add_flag("--once", options->once, "end after the first message");
  command->add_option("--frames", options->frames, "end after that many messages (health counts only when chosen)");
  command->add_flag("--json", options->json, "one JSON object a line");
  command->add_option("--timeout", options->timeout_s, "fail after that many seconds without a message; 0: never")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--domain", options->domain, "DDS domain")
      ->check(CLI::Range(0u, kMaxDomain))
      ->capture_default_str();
  command->add_flag("--loopback", options->loopback, "only this machine, as dds.loopback of wireposed");
  command->callback([options] { Watch(*options); });
}

}  // namespace wirepose::cli
