#include "watch_command.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "bus_options.h"
#include "command.h"
#include "live_table.h"
#include "message_text.h"
#include "subscription.h"

namespace wirepose::cli {
namespace {

struct WatchOptions {
  BusOptions bus;
  std::string topic;  // empty: recognition and health
  bool once = false;
  bool json = false;
  bool plain = false;
  std::uint64_t frames = 0;
  double timeout_s = 10;
};

using Clock = std::chrono::steady_clock;

// A person or a test reads this: waking 200 times a second is soon enough and needs no wait set.
constexpr dds_duration_t kPause = DDS_MSECS(5);
constexpr std::chrono::milliseconds kRedraw{200};
constexpr char kAskLess[] = "try --best-effort, and no --deadline below that of dds.topics";

LiveTable::Time Now() { return std::chrono::system_clock::now().time_since_epoch(); }

void Print(const std::string& text) {
  std::cout << text << std::flush;
  if (!std::cout) throw WorkFailed("cannot write to standard output; is it a closed pipe?");
}

// --- Message by message
// -----------------------------------------------------------------------------------------------

class Printer {
 public:
  virtual ~Printer() = default;
  // Prints what has arrived, at most `limit` messages; returns how many.
  virtual std::uint64_t PrintNew(bool json, std::uint64_t limit) = 0;
  [[nodiscard]] virtual SubscriptionEvents Events() const = 0;
  bool counts = true;  // do messages of this topic count for --frames?
};

template <typename Message>
class TopicPrinter final : public Printer {
 public:
  TopicPrinter(const Bus& bus, TopicId topic) : subscription_(bus, topic) {}

  std::uint64_t PrintNew(bool json, std::uint64_t limit) override {
    std::uint64_t printed = 0;
    while (printed < limit && subscription_.Take()) {
      ++printed;
      // Text may come from another vendor's program: replace what is not UTF-8 instead of failing.
      constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
      Print(json ? ToJson(subscription_.message()).dump(-1, ' ', false, kReplace) + "\n"
                 : ToText(subscription_.message()));
    }
    return printed;
  }
  [[nodiscard]] SubscriptionEvents Events() const override { return subscription_.Events(); }

 private:
  TypedSubscription<Message> subscription_;
};

std::vector<std::unique_ptr<Printer>> Subscribe(const Bus& bus, const std::string& topic) {
  std::vector<std::unique_ptr<Printer>> printers;
  if (topic == "detections") {
    printers.push_back(std::make_unique<TopicPrinter<DetectionsMessage>>(bus, TopicId::kDetections));
  }
  if (topic == "diagnostics") {
    printers.push_back(std::make_unique<TopicPrinter<DiagnosticsMessage>>(bus, TopicId::kDiagnostics));
  }
  if (topic == "command_status") {
    printers.push_back(std::make_unique<TopicPrinter<CommandStatusMessage>>(bus, TopicId::kCommandStatus));
  }
  if (topic.empty() || topic == "recognition") {
    printers.push_back(std::make_unique<TopicPrinter<RecognitionMessage>>(bus, TopicId::kRecognition));
  }
  if (topic.empty() || topic == "health") {
    printers.push_back(std::make_unique<TopicPrinter<HealthMessage>>(bus, TopicId::kHealth));
    printers.back()->counts = !topic.empty();
  }
  return printers;
}

[[noreturn]] void FailForSilence(const WatchOptions& options, bool incompatible) {
  throw WorkFailed(fmt::format("nothing arrived for {} s on {}; {}", options.timeout_s, Where(options.bus),
                               incompatible
                                   ? fmt::format("wireposed offers less than was asked for: {}", kAskLess)
                                   : "is wireposed running with the same domain, loopback setting and topic names?"));
}

void PrintMessages(const WatchOptions& options) {
  const Bus bus = OpenBus(options.bus);
  const auto printers = Subscribe(bus, options.topic);
  const std::uint64_t wanted = options.once ? 1 : options.frames;  // 0: no end
  std::uint64_t counted = 0;
  Clock::time_point last = Clock::now();
  while (wanted == 0 || counted < wanted) {
    std::uint64_t printed = 0;
    for (const auto& printer : printers) {
      const bool limited = printer->counts && wanted > 0;
      const std::uint64_t limit = limited ? wanted - counted : std::numeric_limits<std::uint64_t>::max();
      const std::uint64_t news = printer->PrintNew(options.json, limit);
      printed += news;
      if (printer->counts) counted += news;
    }
    const Clock::time_point now = Clock::now();
    if (printed > 0) last = now;
    if (options.timeout_s > 0 && std::chrono::duration<double>(now - last).count() > options.timeout_s) {
      FailForSilence(options, printers.front()->Events().incompatible);
    }
    if (printed == 0) dds_sleepfor(kPause);
  }
}

// --- Live
// ---------------------------------------------------------------------------------------------------------------

std::size_t TerminalWidth() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 120;
}

// Says what subscribers of the same kind would be told.
void NoteEvents(const SubscriptionEvents& events, LiveTable& table) {
  if (events.liveliness_changed) {
    table.Note(events.publishers > 0 ? "a publisher is there" : "the publisher is gone", Now());
  }
  if (events.deadlines_missed > 0) table.Note(fmt::format("{} deadlines missed", events.deadlines_missed), Now());
  if (events.incompatible) table.Note(fmt::format("the publisher offers less than was asked for: {}", kAskLess), Now());
}

// Draws over itself until interrupted. Silence is shown, not an error: a robot may start later.
void ShowLive(const WatchOptions& options) {
  const Bus bus = OpenBus(options.bus);
  TypedSubscription<RecognitionMessage> recognition(bus, TopicId::kRecognition);
  TypedSubscription<HealthMessage> health(bus, TopicId::kHealth);
  LiveTable table;
  for (;;) {
    const Clock::time_point next = Clock::now() + kRedraw;
    while (Clock::now() < next) {
      while (recognition.Take()) table.Add(recognition.message(), Now());
      while (health.Take()) table.Add(health.message(), Now());
      dds_sleepfor(kPause);
    }
    NoteEvents(recognition.Events(), table);
    // Home, draw, clear what is left of the longer picture before.
    constexpr const char* kHome = "\x1b[H";
    constexpr const char* kClearBelow = "\x1b[J";
    std::string picture = table.Draw(Now(), TerminalWidth());
    for (std::size_t at = 0; (at = picture.find('\n', at)) != std::string::npos; at += 4) {
      picture.insert(at, "\x1b[K");
    }
    Print(kHome + fmt::format("wirepose watch, {} (end with Ctrl-C)\x1b[K\n", Where(options.bus)) + picture +
          kClearBelow);
  }
}

void Watch(const WatchOptions& options) {
  const bool live = isatty(STDOUT_FILENO) != 0 && !options.once && !options.json && !options.plain &&
                    options.topic.empty() && options.frames == 0;
  if (!live) {
    PrintMessages(options);
    return;
  }
  Print("\x1b[2J");
  ShowLive(options);
}

}  // namespace

void AddWatchCommand(CLI::App& app) {
  const auto options = std::make_shared<WatchOptions>();
  CLI::App* const command =
      app.add_subcommand("watch", "show what wireposed publishes: a live table on a terminal, else one by one");
  command->add_option("--topic", options->topic, "only this one, message by message; default: recognition and health")
      ->check(CLI::IsMember({"detections", "recognition", "health", "diagnostics", "command_status"}));
  command->add_flag("--once", options->once, "end after the first message");
  command->add_option("--frames", options->frames, "end after that many messages (health counts only when chosen)");
  command->add_flag("--json", options->json, "one JSON object a line");
  command->add_flag("--plain", options->plain, "message by message also on a terminal");
  command->add_option("--timeout", options->timeout_s, "fail after that many seconds without a message; 0: never")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--deadline", options->bus.deadline_ms,
                      "live table: tell when no recognition comes for that many ms; wireposed must promise as much "
                      "(deadline_ms of dds.topics)");
  AddBusOptions(*command, options->bus);
  command->callback([options] { Watch(*options); });
}

}  // namespace wirepose::cli
