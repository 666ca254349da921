// Publishes reports on DDS from a thread of its own.
#ifndef WIREPOSE_PUBLISH_PUBLISHER_H_
#define WIREPOSE_PUBLISH_PUBLISHER_H_

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include "base/result.h"
#include "model/model_view.h"
#include "publish/bus.h"
#include "publish/messages.h"
#include "publish/outbox.h"

namespace wirepose {

struct PublisherConfig {
  BusConfig bus;
  std::string frame_id;  // of the poses: the left camera's optical frame
  std::string version;
};

// The robot program's result sink. Its messages and queue are part of the object: make it static.
//
// Threads: one thread owns it (Open, Publish, Close); the counters may be read anywhere. Publish
// never waits for the network: what the publisher's thread cannot take in time is dropped and
// counted.
class Publisher {
 public:
  Publisher() = default;
  ~Publisher() { Close(); }
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  // Joins the bus and starts the thread. `models` (and the bytes behind it) must stay unchanged
  // until Close.
  Result<void, std::string> Open(const PublisherConfig& config, std::span<const ModelView> models);
  // Sends what waits, leaves the bus and ends the thread. Idempotent.
  void Close();

  // False when the report was dropped.
  bool Publish(const FrameReport& report) { return outbox_.Offer(report); }
  bool Publish(const HealthReport& report) { return outbox_.Offer(report); }

  // Frame reports dropped since the start; messages that DDS refused.
  [[nodiscard]] std::uint64_t results_dropped() const { return outbox_.dropped(); }
  [[nodiscard]] std::uint64_t write_errors() const { return write_errors_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t queue_high_water() const { return outbox_.high_water(); }
  [[nodiscard]] std::size_t queue_capacity() const { return outbox_.capacity(); }

 private:
  void Run();
  void Drain();
  void Write(dds_entity_t writer, const void* message);

  PublisherConfig config_;
  std::span<const ModelView> models_;
  std::optional<Bus> bus_;
  dds_entity_t detections_writer_ = 0, recognition_writer_ = 0, health_writer_ = 0;
  Outbox outbox_;
  DetectionsMessage detections_;
  RecognitionMessage recognition_;
  HealthReport health_report_;
  HealthMessage health_;
  std::atomic<std::uint64_t> write_errors_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_PUBLISHER_H_
