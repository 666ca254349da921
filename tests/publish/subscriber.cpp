// A subscriber as a process of its own, for tests: subscriber DOMAIN TOPIC... Prints "data" at the first sample and
// "count N" every 100 ms in which samples came; once it gets SIGTERM, one line of JSON for each topic. Joins this
// machine only, or with WIREPOSE_TEST_NETWORK set what CYCLONEDDS_URI says.
#include <sys/prctl.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "publish/bus.h"
#include "publish/messages.h"

namespace wirepose {
namespace {

volatile std::sig_atomic_t g_stop = 0;

std::int64_t Now_ns() { return std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1); }

// What one topic brought.
struct Tally {
  std::string key;
  std::uint64_t samples = 0, last_sequence = 0;
  std::int64_t last_ns = 0, longest_gap_ns = 0;
  std::vector<std::int64_t> latencies_ns;  // where the message tells when it was made

  void Add(std::int64_t stamp_ns, std::uint64_t sequence) {
    const std::int64_t now = Now_ns();
    if (samples > 0) longest_gap_ns = std::max(longest_gap_ns, now - last_ns);
    ++samples;
    last_ns = now;
    last_sequence = sequence;
    if (stamp_ns != 0) latencies_ns.push_back(now - stamp_ns);
  }
  [[nodiscard]] std::int64_t Percentile(std::size_t percent) {
    if (latencies_ns.empty()) return 0;
    std::sort(latencies_ns.begin(), latencies_ns.end());
    return latencies_ns[(latencies_ns.size() - 1) * percent / 100];
  }
  void Print() {
    std::printf(
        "{\"topic\":\"%s\",\"samples\":%llu,\"last_sequence\":%llu,\"longest_gap_ms\":%.3f,\"p50_us\":%.1f,"
        "\"p99_us\":%.1f,\"max_us\":%.1f}\n",
        key.c_str(), static_cast<unsigned long long>(samples), static_cast<unsigned long long>(last_sequence),
        1e-6 * static_cast<double>(longest_gap_ns), 1e-3 * static_cast<double>(Percentile(50)),
        1e-3 * static_cast<double>(Percentile(99)), 1e-3 * static_cast<double>(Percentile(100)));
  }
};

// Counts samples of any type; reads those whose time is known.
class Listener {
 public:
  Listener(const Bus& bus, TopicId topic) : topic_(topic) {
    tally.key = Spec(topic).key;
    const Result<dds_entity_t, std::string> reader = bus.CreateReader(topic);
    if (!reader) {
      std::fprintf(stderr, "%s\n", reader.error().c_str());
      std::exit(1);
    }
    reader_ = *reader;
  }

  [[nodiscard]] dds_entity_t reader() const { return reader_; }

  void TakeAll() {
    dds_sample_info_t info{};
    if (topic_ == TopicId::kRecognition) {
      void* samples[] = {&recognition_->value};
      while (dds_take(reader_, samples, &info, 1, 1) > 0) {
        if (info.valid_data) tally.Add(recognition_->value.stamp_ns, recognition_->value.frame_sequence);
      }
      return;
    }
    if (topic_ == TopicId::kDetections) {
      void* samples[] = {&detections_->value};
      while (dds_take(reader_, samples, &info, 1, 1) > 0) {
        const auto& stamp = detections_->value.header.stamp;
        if (info.valid_data) tally.Add(std::int64_t{stamp.sec} * 1'000'000'000 + stamp.nanosec, 0);
      }
      return;
    }
    for (void* sample = nullptr; dds_take(reader_, &sample, &info, 1, 1) > 0; sample = nullptr) {
      if (info.valid_data) tally.Add(0, 0);
      (void)dds_return_loan(reader_, &sample, 1);
    }
  }

  Tally tally;

 private:
  TopicId topic_;
  dds_entity_t reader_ = 0;
  std::unique_ptr<RecognitionMessage> recognition_ = std::make_unique<RecognitionMessage>();
  std::unique_ptr<DetectionsMessage> detections_ = std::make_unique<DetectionsMessage>();
};

int Main(int argc, char** argv) {
  std::signal(SIGTERM, [](int) { g_stop = 1; });
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // a test that dies leaves nobody behind
  BusConfig config;
  config.domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  config.loopback = std::getenv("WIREPOSE_TEST_NETWORK") == nullptr;
  const Result<Bus, std::string> bus = Bus::Open(config);
  if (!bus) {
    std::fprintf(stderr, "%s\n", bus.error().c_str());
    return 1;
  }
  std::vector<std::unique_ptr<Listener>> listeners;
  const dds_entity_t waitset = dds_create_waitset(bus->participant());
  for (int i = 2; i < argc; ++i) {
    for (std::size_t t = 0; t < kTopicCount; ++t) {
      const auto topic = static_cast<TopicId>(t);
      if (std::string(Spec(topic).key) != argv[i]) continue;
      listeners.push_back(std::make_unique<Listener>(*bus, topic));
      const dds_entity_t reader = listeners.back()->reader();
      dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
      dds_waitset_attach(waitset, reader, 0);
    }
  }
  bool any = false;
  std::uint64_t told = 0;
  std::int64_t told_ns = 0;
  while (g_stop == 0) {
    dds_waitset_wait(waitset, nullptr, 0, DDS_MSECS(50));
    for (const auto& listener : listeners) {
      listener->TakeAll();
      if (listener->tally.samples > 0 && !any) {
        any = true;
        std::puts("data");
        std::fflush(stdout);
      }
    }
    std::uint64_t count = 0;
    for (const auto& listener : listeners) count += listener->tally.samples;
    if (count != told && Now_ns() - told_ns > 100'000'000) {
      told = count;
      told_ns = Now_ns();
      std::printf("count %llu\n", static_cast<unsigned long long>(count));
      std::fflush(stdout);
    }
  }
  for (const auto& listener : listeners) listener->tally.Print();
  return 0;
}

}  // namespace
}  // namespace wirepose

// Asked by LeakSanitizer where it is linked in: Cyclone DDS 0.10 keeps 2 KiB of a participant that was found again.
// NOLINTNEXTLINE(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions() { return "leak:libddsc.so\n"; }

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("usage: subscriber DOMAIN TOPIC...\n", stderr);
    return 2;
  }
  return wirepose::Main(argc, argv);
}
