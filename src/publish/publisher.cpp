#include "publish/publisher.h"

namespace wirepose {

Result<void, std::string> Publisher::Open(const PublisherConfig& config, std::span<const ModelView> models) {
  Close();
  Result<Bus, std::string> bus = Bus::Open(config.bus);
  if (!bus) return unexpected(bus.error());
  const struct {
    const TopicSpec& topic;
    dds_entity_t& writer;
  } endpoints[] = {
      {kDetectionsTopic, detections_writer_}, {kRecognitionTopic, recognition_writer_}, {kHealthTopic, health_writer_}};
  for (const auto& [topic, writer] : endpoints) {
    const Result<dds_entity_t, std::string> created = bus->CreateWriter(topic);
    if (!created) return unexpected(created.error());
    writer = *created;
  }
  config_ = config;
  models_ = models;
  bus_.emplace(std::move(*bus));
  stop_ = false;
  thread_ = std::thread([this] { Run(); });
  return {};
}

void Publisher::Close() {
  if (!thread_.joinable()) return;
  stop_ = true;
  outbox_.Wake();
  thread_.join();
  // A reliable writer waits here, up to Cyclone's linger time (1 s), for readers to acknowledge the
  // last messages.
  bus_.reset();
}

void Publisher::Run() {
  while (!stop_) {
    outbox_.Wait();
    Drain();
  }
  Drain();
}

void Publisher::Drain() {
  while (const FrameReport* const report = outbox_.TakeFrame()) {
    FillMessage(*report, models_, config_.frame_id, detections_);
    FillMessage(*report, models_, config_.frame_id, recognition_);
    outbox_.Release(report);
    Write(detections_writer_, &detections_.value);
    Write(recognition_writer_, &recognition_.value);
  }
  while (outbox_.TakeHealth(health_report_)) {
    FillMessage(health_report_, models_, config_.version, health_);
    Write(health_writer_, &health_.value);
  }
}

void Publisher::Write(dds_entity_t writer, const void* message) {
  if (dds_write(writer, message) < 0) write_errors_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace wirepose
