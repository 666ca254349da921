#include "publish/publisher.h"

#include "base/check.h"

namespace wirepose {
namespace {

constexpr TopicId kWritten[] = {TopicId::kDetections,  TopicId::kRecognition, TopicId::kHealth,       TopicId::kMarkers,
                                TopicId::kDiagnostics, TopicId::kImage,       TopicId::kCommandStatus};

void WakeOnData(dds_entity_t, void* outbox) { static_cast<Outbox*>(outbox)->Wake(); }

std::uint32_t Subscribers(dds_entity_t writer) {
  dds_publication_matched_status_t status{};
  return dds_get_publication_matched_status(writer, &status) < 0 ? 0 : status.current_count;
}

}  // namespace

Publisher::Publisher()
    : detections_type_(*Spec(TopicId::kDetections).type),
      recognition_type_(*Spec(TopicId::kRecognition).type),
      health_type_(*Spec(TopicId::kHealth).type),
      markers_type_(*Spec(TopicId::kMarkers).type),
      diagnostics_type_(*Spec(TopicId::kDiagnostics).type),
      image_type_(*Spec(TopicId::kImage).type),
      command_status_type_(*Spec(TopicId::kCommandStatus).type) {}

SlotType& Publisher::TypeOf(TopicId topic) {
  switch (topic) {
    case TopicId::kDetections:
      return *detections_type_;
    case TopicId::kRecognition:
      return *recognition_type_;
    case TopicId::kHealth:
      return *health_type_;
    case TopicId::kMarkers:
      return *markers_type_;
    case TopicId::kDiagnostics:
      return *diagnostics_type_;
    case TopicId::kImage:
      return *image_type_;
    case TopicId::kCommandStatus:
    case TopicId::kCommand:
      break;
  }
  return *command_status_type_;
}

Result<void, std::string> Publisher::Open(const PublisherConfig& config) {
  Close();
  config_ = config;
  SetDdsPoolSize(config.pool_bytes);
  Result<Bus, std::string> bus = Bus::Open(config.bus);
  if (!bus) return unexpected(bus.error());
  bus_.emplace(std::move(*bus));
  if (Result<void, std::string> created = CreateEndpoints(); !created) {
    bus_.reset();
    return created;
  }
  stop_ = false;
  thread_ = std::thread([this] { Run(); });
  return {};
}

Result<void, std::string> Publisher::CreateEndpoints() {
  for (const TopicId topic : kWritten) {
    const Result<dds_entity_t, std::string> created = bus_->CreateWriter(topic, &TypeOf(topic));
    if (!created) return unexpected(created.error());
    writers_[static_cast<std::size_t>(topic)] = *created;
  }
  dds_listener_t* const listener = dds_create_listener(&outbox_);
  dds_lset_data_available(listener, WakeOnData);
  const Result<dds_entity_t, std::string> reader = bus_->CreateReader(TopicId::kCommand, listener);
  dds_delete_listener(listener);  // the reader has its own copy
  if (!reader) return unexpected(reader.error());
  command_reader_ = *reader;
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

void Publisher::Answer(const CommandAnswer& answer) {
  // There is room unless somebody answers twice.
  Check(outbox_.Offer(answer));
}

void Publisher::Run() {
  while (!stop_) {
    outbox_.Wait();
    Drain();
  }
  Drain();
}

void Publisher::Drain() {
  SendFrames();
  SendScene();
  SendImage();
  TakeCommands();
  SendAnswers();
  SendHealth();
}

void Publisher::SendFrames() {
  std::uint64_t dropped = 0;
  while (const FrameReport* const report = outbox_.TakeFrame(dropped)) {
    FillMessage(*report, config_.frame_id, detections_);
    FillMessage(*report, config_.frame_id, recognition_);
    outbox_.Release(report);
    recognition_.value.results_dropped = dropped;
    Write(TopicId::kDetections, &detections_.value);
    Write(TopicId::kRecognition, &recognition_.value);
  }
  scene_wanted_.store(Subscribers(writer(TopicId::kMarkers)) > 0, std::memory_order_relaxed);
  image_wanted_.store(Subscribers(writer(TopicId::kImage)) > 0, std::memory_order_relaxed);
}

void Publisher::SendScene() {
  const SceneReport* const scene = outbox_.TakeScene();
  if (scene == nullptr) return;
  FillMessage(*scene, config_.frame_id, markers_);
  outbox_.Release(scene);
  Write(TopicId::kMarkers, &markers_.value);
}

void Publisher::SendImage() {
  const ImageReport* const image = outbox_.TakeImage();
  if (image == nullptr) return;
  FillMessage(*image, config_.frame_id, image_);
  Write(TopicId::kImage, &image_);
  outbox_.Release(image);
}

void Publisher::SendHealth() {
  const HealthReport* const report = outbox_.TakeHealth();
  if (report == nullptr) return;
  health_report_ = *report;
  outbox_.Release(report);
  UpdateEvents();
  health_report_.pool = DdsPoolUse();
  health_report_.events = events_;
  FillMessage(health_report_, config_.version, health_);
  FillMessage(health_report_, losses_.Update(health_report_), diagnostics_);
  Write(TopicId::kHealth, &health_.value);
  Write(TopicId::kDiagnostics, &diagnostics_.value);
}

void Publisher::SendAnswers() {
  while (outbox_.TakeAnswer(answer_)) {
    ++(answer_.accepted ? events_.commands_accepted : events_.commands_refused);
    FillMessage(answer_, command_status_);
    Write(TopicId::kCommandStatus, &command_status_.value);
  }
}

// Commands stay in the reader while the program has enough to do.
void Publisher::TakeCommands() {
  void* samples[] = {&command_.value};
  dds_sample_info_t info{};
  while (commands_.size() < kCommands && dds_take(command_reader_, samples, &info, 1, 1) > 0) {
    if (!info.valid_data) continue;  // only says that a sender has gone
    Check(commands_.try_push(ReadMessage(command_.value)));
  }
}

void Publisher::UpdateEvents() {
  events_.subscribers = events_.deadlines_missed = events_.incompatible_qos = 0;
  for (const TopicId topic : kWritten) {
    events_.subscribers += Subscribers(writer(topic));
    dds_offered_deadline_missed_status_t missed{};
    if (dds_get_offered_deadline_missed_status(writer(topic), &missed) >= 0) {
      events_.deadlines_missed += missed.total_count;
    }
    dds_offered_incompatible_qos_status_t incompatible{};
    if (dds_get_offered_incompatible_qos_status(writer(topic), &incompatible) >= 0) {
      events_.incompatible_qos += incompatible.total_count;
    }
  }
  dds_requested_incompatible_qos_status_t incompatible{};
  if (dds_get_requested_incompatible_qos_status(command_reader_, &incompatible) >= 0) {
    events_.incompatible_qos += incompatible.total_count;
  }
}

void Publisher::Write(TopicId topic, const void* message) {
  if (dds_write(writer(topic), message) < 0) write_errors_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace wirepose
