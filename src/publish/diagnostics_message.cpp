// rt/diagnostics: health as robot monitors show it.
#include <cstdio>

#include "publish/message_parts.h"
#include "publish/messages.h"

namespace wirepose {
namespace {

static_assert(kDiagnosticStatuses == 4 && kMaxDiagnosticValues == 32, "change dds_idl/diagnostic_msgs.idl too");
static_assert(kMaxModels <= kMaxDiagnosticValues && kStageCount + 1 + kMaxLists <= kMaxDiagnosticValues);

enum Level : std::uint8_t { kOk = 0, kWarning = 1, kError = 2 };  // of diagnostic_msgs/msg/DiagnosticStatus

// Above that share of the pool somebody should look before it is full.
constexpr std::size_t kPoolWarning_percent = 85;

using Status = diagnostic_msgs_msg_dds__DiagnosticStatus_;

// Begins a status in the next free place of the message.
Status& Add(DiagnosticsMessage& message, const char* name, std::string_view hardware) {
  auto& statuses = message.value.status;
  Status& status = statuses._buffer[statuses._length++];
  status.level = kOk;
  CopyText(name, status.name);
  CopyText("ok", status.message);
  CopyText(hardware, status.hardware_id);
  status.values._length = 0;
  return status;
}

void AddText(Status& status, std::string_view key, std::string_view value) {
  auto& entry = status.values._buffer[status.values._length++];
  CopyText(key, entry.key);
  CopyText(value, entry.value);
}

// Formats numbers and short words.
template <typename... Arguments>
void AddValue(Status& status, std::string_view key, const char* format, Arguments... arguments) {
  char text[sizeof(diagnostic_msgs_msg_dds__KeyValue_::value)];
  std::snprintf(text, sizeof text, format, arguments...);
  AddText(status, key, text);
}

void Raise(Status& status, Level level, std::string_view message) {
  if (level < status.level || message.empty()) return;
  status.level = level;
  CopyText(message, status.message);
}

using Count = unsigned long long;

void AddRows(const RowAlignment& rows, Status& status) {
  AddValue(status, "row offset steady", "%.2f px", static_cast<double>(rows.steady_px));
  AddValue(status, "row offset varying", "%.2f px", static_cast<double>(rows.varying_px));
  AddValue(status, "row offset corners", "%u", rows.corners);
  if (rows.state == RowState::kSteadyOffset) {
    Raise(status, kWarning, "rows of the eyes are steadily off: calibrate again");
  }
  if (rows.state == RowState::kVaryingOffset) {
    Raise(status, kWarning, "rows of the eyes are off at times: not exposed together, or a loose eye");
  }
}

void AddCamera(const HealthReport& report, DiagnosticsMessage& message) {
  Status& status = Add(message, "wireposed: camera", report.camera);
  const FrameCounts& frames = report.frames;
  switch (report.state) {
    case HealthState::kRunning:
    case HealthState::kPaused:
    case HealthState::kStarting:
    case HealthState::kStopped:
      CopyText(Describe(report.state), status.message);
      break;
    case HealthState::kBadFrames:
      Raise(status, kWarning, report.camera_status);
      break;
    case HealthState::kNoFrames:
    case HealthState::kCameraLost:
      Raise(status, kError, report.camera_status);
      break;
  }
  AddText(status, "state", Describe(report.state));
  AddValue(status, "good frames", "%llu", Count{frames.good});
  AddValue(status, "missing", "%llu", Count{frames.missing});
  AddValue(status, "damaged", "%llu", Count{frames.damaged});
  AddValue(status, "not synchronous", "%llu", Count{frames.not_synchronous});
  AddValue(status, "late", "%llu", Count{frames.late});
  AddValue(status, "failed", "%llu", Count{frames.failed});
  AddText(status, "last error", report.last_error);
  AddRows(report.rows, status);
}

void AddRecognition(const HealthReport& report, const RecentLosses& losses, DiagnosticsMessage& message) {
  Status& status = Add(message, "wireposed: recognition", report.camera);
  for (const StageTime& time : report.stage_times) {
    AddValue(status, std::string_view(time.stage), "p50 %.3f ms, p99 %.3f ms", 1e-6 * static_cast<double>(time.p50_ns),
             1e-6 * static_cast<double>(time.p99_ns));
  }
  AddValue(status, "detections dropped", "%u", report.lists.detections.dropped);
  if (losses.detections) Raise(status, kWarning, "more objects than a message can hold");
}

void AddBus(const HealthReport& report, const RecentLosses& losses, DiagnosticsMessage& message) {
  Status& status = Add(message, "wireposed: bus", "");
  const BusEvents& events = report.events;
  AddValue(status, "subscribers", "%u", events.subscribers);
  AddValue(status, "results dropped", "%llu", Count{report.results_dropped});
  AddValue(status, "write errors", "%llu", Count{report.write_errors});
  AddValue(status, "deadlines missed", "%u", events.deadlines_missed);
  AddValue(status, "incompatible qos", "%u", events.incompatible_qos);
  AddValue(status, "commands accepted", "%u", events.commands_accepted);
  AddValue(status, "commands refused", "%u", events.commands_refused);
  AddValue(status, "pool high water", "%zu of %zu KiB", report.pool.high_water >> 10, report.pool.capacity >> 10);
  if (losses.results) Raise(status, kWarning, "results were dropped: the bus is slower than the camera");
  if (losses.messages) Raise(status, kWarning, "messages were refused by DDS");
  if (report.pool.used * 100 > report.pool.capacity * kPoolWarning_percent) {
    Raise(status, kWarning, "the DDS pool is nearly full: raise dds.pool_kib");
  }
}

void AddModels(const HealthReport& report, DiagnosticsMessage& message) {
  Status& status = Add(message, "wireposed: models", "");
  for (const ModelLabel& model : report.models) {
    AddValue(status, std::string_view(model.name), "id %u, %08x%s", model.id, model.checksum,
             model.searched ? "" : ", not searched for");
  }
  if (report.models.empty()) Raise(status, kWarning, "no model is loaded");
}

}  // namespace

DiagnosticsMessage::DiagnosticsMessage() {
  Attach(value.status, statuses_);
  for (std::size_t i = 0; i < kDiagnosticStatuses; ++i) Attach(statuses_[i].values, values_[i]);
}

void FillMessage(const HealthReport& report, const RecentLosses& losses, DiagnosticsMessage& message) {
  message.value.header = RosHeader(report.stamp, "");
  message.value.status._length = 0;
  AddCamera(report, message);
  AddRecognition(report, losses, message);
  AddBus(report, losses, message);
  AddModels(report, message);
}

}  // namespace wirepose
