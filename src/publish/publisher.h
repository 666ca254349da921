// Publishes reports on DDS from a thread of its own, and takes commands.
#ifndef WIREPOSE_PUBLISH_PUBLISHER_H_
#define WIREPOSE_PUBLISH_PUBLISHER_H_

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include "base/result.h"
#include "base/spsc_queue.h"
#include "publish/bus.h"
#include "publish/dds_pool.h"
#include "publish/messages.h"
#include "publish/outbox.h"
#include "publish/slot_type.h"

namespace wirepose {

struct PublisherConfig {
  BusConfig bus;
  std::string frame_id;  // of the poses: the left camera's optical frame
  std::string version;
  std::size_t pool_bytes = kDefaultDdsPoolBytes;  // for DDS, where the program has a pool
};

// The robot program's result sink and its ear. Messages, queue and the writers' memory are part of the object: make it
// static.
//
// Threads: one thread owns it (Open, Publish, Answer, TakeCommand, Close); the counters may be read anywhere. No call
// but Open and Close waits for the network: what the publisher's thread cannot send in time is given up, the oldest
// first, and counted.
class Publisher {
 public:
  Publisher();
  ~Publisher() { Close(); }
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  // Joins the bus and starts the thread.
  Result<void, std::string> Open(const PublisherConfig& config);
  // Sends what waits, leaves the bus and ends the thread. Idempotent.
  void Close();

  void Publish(const FrameReport& report) { outbox_.Offer(report); }
  // Also fills in what only the bus knows: pool and events.
  void Publish(const HealthReport& report) { outbox_.Offer(report); }
  void Publish(const SceneReport& scene) { outbox_.Offer(scene); }
  void Publish(const ImageReport& image) { outbox_.Offer(image); }
  // True while somebody subscribes to the markers or to the image: only then a scene or a picture need be gathered.
  [[nodiscard]] bool SceneWanted() const { return scene_wanted_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool ImageWanted() const { return image_wanted_.load(std::memory_order_relaxed); }

  // The next command, in the order of arrival. Each must be answered, before the next one is taken.
  [[nodiscard]] bool TakeCommand(Command& command) { return commands_.try_pop(command); }
  void Answer(const CommandAnswer& answer);

  // Frame reports given up since the start; messages that DDS refused.
  [[nodiscard]] std::uint64_t results_dropped() const { return outbox_.dropped(); }
  [[nodiscard]] std::uint64_t write_errors() const { return write_errors_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t queue_high_water() const { return outbox_.high_water(); }
  [[nodiscard]] std::size_t queue_capacity() const { return outbox_.capacity(); }

 private:
  static constexpr std::size_t kCommands = 8;
  static_assert(2 * kCommands <= Outbox::kAnswers, "answers find room, also while the next commands are taken");

  Result<void, std::string> CreateEndpoints();
  [[nodiscard]] SlotType& TypeOf(TopicId topic);
  [[nodiscard]] dds_entity_t writer(TopicId topic) const { return writers_[static_cast<std::size_t>(topic)]; }
  void Run();
  void Drain();
  void SendFrames();
  void SendScene();
  void SendImage();
  void SendHealth();
  void SendAnswers();
  void TakeCommands();
  void UpdateEvents();
  void Write(TopicId topic, const void* message);

  PublisherConfig config_;
  Outbox outbox_;
  SpscQueue<Command, kCommands> commands_;

  // The writers' memory: as many slots as the history holds, and some for samples on their way. Sizes: the largest
  // message that the type's bounds allow (tests/publish/messages_test.cpp).
  StaticSlotType<kMaxDetectionsBytes, 8> detections_type_;
  StaticSlotType<kMaxRecognitionBytes, 8> recognition_type_;
  StaticSlotType<kMaxHealthBytes, 4> health_type_;
  StaticSlotType<kMaxMarkersBytes, 4> markers_type_;
  StaticSlotType<kMaxDiagnosticsBytes, 4> diagnostics_type_;
  StaticSlotType<kMaxImageBytes, 3> image_type_;
  StaticSlotType<kMaxCommandStatusBytes, 20> command_status_type_;

  // Of the publisher's thread.
  DetectionsMessage detections_;
  RecognitionMessage recognition_;
  HealthReport health_report_;
  HealthMessage health_;
  MarkersMessage markers_;
  DiagnosticsMessage diagnostics_;
  sensor_msgs_msg_dds__Image_ image_{};
  CommandMessage command_;
  CommandStatusMessage command_status_;
  CommandAnswer answer_;
  BusEvents events_;
  LossMonitor losses_;

  std::atomic<std::uint64_t> write_errors_{0};
  std::atomic<bool> scene_wanted_{false}, image_wanted_{false};
  std::atomic<bool> stop_{false};
  std::optional<Bus> bus_;  // goes before the types
  std::array<dds_entity_t, kTopicCount> writers_{};
  dds_entity_t command_reader_ = 0;
  std::thread thread_;
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_PUBLISHER_H_
