#include "message_text.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

namespace wirepose::cli {

double PositionSigma(const double (&covariance)[36]) {
  return std::sqrt(covariance[0] + covariance[7] + covariance[14]);
}

double RotationSigma_deg(const double (&covariance)[36]) {
  constexpr double kDegrees = 180 / 3.14159265358979323846;
  return kDegrees * std::sqrt(covariance[21] + covariance[28] + covariance[35]);
}

namespace {

template <typename Sequence>
auto Elements(const Sequence& sequence) {
  return std::span(sequence._buffer, sequence._length);
}

double Milliseconds(std::uint64_t ns) { return 1e-6 * static_cast<double>(ns); }

std::string Spread(const double (&covariance)[36]) {
  return fmt::format("+-{:.1f} mm +-{:.2f} deg", 1e3 * PositionSigma(covariance), RotationSigma_deg(covariance));
}

std::string DetectionText(const wirepose_Detection& detection) {
  const auto& p = detection.pose.position_m;
  const auto& q = detection.pose.orientation_xyzw;
  std::string text = fmt::format(
      "  {} (id {}) at [{:.4f} {:.4f} {:.4f}] m, q [{:.4f} {:.4f} {:.4f} {:.4f}], {}, score "
      "{:.3f}, visible {:.2f}",
      detection.name, detection.model_id, p[0], p[1], p[2], q[0], q[1], q[2], q[3], Spread(detection.covariance),
      detection.score, detection.visible_fraction);
  if (detection.track_id != 0) text += fmt::format(", track {}", detection.track_id);
  if (detection.modes._length > 0) text += fmt::format(", {} modes", detection.modes._length);
  return text + "\n";
}

}  // namespace

const char* StateName(wirepose_HealthState state) {
  switch (state) {
    case wirepose_STARTING:
      return "starting";
    case wirepose_RUNNING:
      return "running";
    case wirepose_BAD_FRAMES:
      return "bad_frames";
    case wirepose_NO_FRAMES:
      return "no_frames";
    case wirepose_CAMERA_LOST:
      return "camera_lost";
    case wirepose_PAUSED:
      return "paused";
    case wirepose_STOPPED:
      return "stopped";
  }
  return "?";
}

const char* StateName(wirepose_RowState state) {
  switch (state) {
    case wirepose_ROWS_UNKNOWN:
      return "unknown";
    case wirepose_ROWS_ALIGNED:
      return "aligned";
    case wirepose_ROWS_STEADILY_OFF:
      return "steadily_off";
    case wirepose_ROWS_VARYINGLY_OFF:
      return "varyingly_off";
  }
  return "?";
}

std::string ToText(const wirepose_Recognition& message) {
  std::string text =
      fmt::format("frame {} at {:.3f} s: {} object{}{}\n", message.frame_sequence,
                  1e-9 * static_cast<double>(message.capture_time_ns), message.detections._length,
                  message.detections._length == 1 ? "" : "s", message.budget_hit ? ", search budget hit" : "");
  for (const wirepose_Detection& detection : Elements(message.detections)) text += DetectionText(detection);
  return text;
}

std::string ToText(const vision_msgs_msg_dds__Detection3DArray_& message) {
  std::string text = fmt::format("detections in {} at {}.{:09} s: {}\n", message.header.frame_id,
                                 message.header.stamp.sec, message.header.stamp.nanosec, message.detections._length);
  for (const auto& detection : Elements(message.detections)) {
    for (const auto& result : Elements(detection.results)) {
      const auto& [p, q] = result.pose.pose;
      text += fmt::format("  {} at [{:.4f} {:.4f} {:.4f}] m, q [{:.4f} {:.4f} {:.4f} {:.4f}], {}, score {:.3f}\n",
                          result.hypothesis.class_id, p.x, p.y, p.z, q.x, q.y, q.z, q.w, Spread(result.pose.covariance),
                          result.hypothesis.score);
    }
  }
  return text;
}

std::string ToText(const wirepose_Health& message) {
  const wirepose_FrameCounts& f = message.frames;
  std::string text = fmt::format(
      "health: {}, wireposed {}, up {:.1f} s, camera {}: {}\n"
      "  frames: {} good, {} missing, {} damaged, {} not synchronous, {} late, {} failed; "
      "results dropped {}, write errors {}\n"
      "  bus: {} subscribers, {} deadlines missed, {} incompatible, commands {} accepted {} refused; pool {} of {} "
      "KiB, "
      "most {}\n",
      StateName(message.state), message.version, 1e-9 * static_cast<double>(message.uptime_ns), message.camera,
      message.camera_status, f.good, f.missing, f.damaged, f.not_synchronous, f.late, f.failed, message.results_dropped,
      message.write_errors, message.events.subscribers, message.events.deadlines_missed,
      message.events.incompatible_qos, message.events.commands_accepted, message.events.commands_refused,
      message.pool.used_bytes >> 10, message.pool.capacity_bytes >> 10, message.pool.high_water_bytes >> 10);
  const wirepose_RowAlignment& rows = message.rows;
  text += fmt::format(
      "  rows of the eyes: {}, steady {:.2f} px, varying {:.2f} px; last frame {} corners, median {:.2f} px, spread "
      "{:.2f} px\n",
      StateName(rows.state), rows.steady_px, rows.varying_px, rows.corners, rows.median_px, rows.spread_px);
  for (const wirepose_StageTime& time : Elements(message.stage_times)) {
    text += fmt::format("  {:<16} p50 {:8.3f} ms  p99 {:8.3f} ms  max {:8.3f} ms\n", time.stage,
                        Milliseconds(time.p50_ns), Milliseconds(time.p99_ns), Milliseconds(time.max_ns));
  }
  for (const wirepose_ModelStatus& model : Elements(message.models)) {
    text += fmt::format("  model {} {} ({:08x}){}\n", model.id, model.name, model.checksum,
                        model.searched ? "" : ", not searched for");
  }
  if (message.last_error[0] != '\0') text += fmt::format("  last error: {}\n", message.last_error);
  return text;
}

const char* ActionName(std::uint8_t action) {
  switch (action) {
    case wirepose_SELECT_MODELS:
      return "select";
    case wirepose_SET_REGION:
      return "region";
    case wirepose_PAUSE:
      return "pause";
    case wirepose_RESUME:
      return "resume";
    case wirepose_RELOAD_MODELS:
      return "reload";
    default:
      return "unknown";
  }
}

std::string ToText(const wirepose_CommandStatus& message) {
  std::string text = fmt::format(
      "{} (request {} of {}): {}{}\n  now {}, models", ActionName(message.action), message.request_id, message.sender,
      message.accepted ? "accepted" : "refused: ", message.reason, message.paused ? "paused" : "not paused");
  for (const std::uint32_t id : Elements(message.searched_ids)) text += fmt::format(" {}", id);
  const wirepose_Region& region = message.region;
  if (region.width_px != 0) {
    text += fmt::format(", region {} {} {} {}", region.x_px, region.y_px, region.width_px, region.height_px);
  }
  return text + "\n";
}

std::string ToText(const diagnostic_msgs_msg_dds__DiagnosticArray_& message) {
  constexpr const char* kLevels[] = {"ok", "warning", "error", "stale"};
  std::string text;
  for (const auto& status : Elements(message.status)) {
    text += fmt::format("{}: {}: {}\n", status.name, kLevels[status.level % 4], status.message);
    for (const auto& value : Elements(status.values)) text += fmt::format("  {}: {}\n", value.key, value.value);
  }
  return text;
}

}  // namespace wirepose::cli
