#include <span>

#include "message_text.h"

namespace wirepose::cli {
namespace {

using Json = nlohmann::ordered_json;

// An array with f(element) for each element of a DDS sequence.
template <typename Sequence, typename F>
Json Each(const Sequence& sequence, F f) {
  Json array = Json::array();
  for (const auto& element : std::span(sequence._buffer, sequence._length)) array.push_back(f(element));
  return array;
}

Json PoseJson(const wirepose_Pose& pose) {
  return {{"position_m", pose.position_m}, {"orientation_xyzw", pose.orientation_xyzw}};
}

Json ListUseJson(const wirepose_ListUse& list) {
  return {{"name", list.name}, {"used", list.used}, {"capacity", list.capacity}, {"dropped", list.dropped}};
}

Json DetectionJson(const wirepose_Detection& detection) {
  return {{"model_id", detection.model_id},
          {"name", detection.name},
          {"pose", PoseJson(detection.pose)},
          {"covariance", detection.covariance},
          {"score", detection.score},
          {"visible_fraction", detection.visible_fraction},
          {"track_id", detection.track_id},
          {"modes", Each(detection.modes, [](const wirepose_PoseMode& mode) {
             return Json{{"pose", PoseJson(mode.pose)}, {"weight", mode.weight}};
           })}};
}

Json RosPoseJson(const geometry_msgs_msg_dds__Pose_& pose) {
  const auto& [p, q] = pose;
  return {{"position", {{"x", p.x}, {"y", p.y}, {"z", p.z}}},
          {"orientation", {{"x", q.x}, {"y", q.y}, {"z", q.z}, {"w", q.w}}}};
}

Json RosHeaderJson(const std_msgs_msg_dds__Header_& header) {
  return {{"stamp", {{"sec", header.stamp.sec}, {"nanosec", header.stamp.nanosec}}}, {"frame_id", header.frame_id}};
}

Json RosResultJson(const vision_msgs_msg_dds__ObjectHypothesisWithPose_& result) {
  return {{"hypothesis", {{"class_id", result.hypothesis.class_id}, {"score", result.hypothesis.score}}},
          {"pose", {{"pose", RosPoseJson(result.pose.pose)}, {"covariance", result.pose.covariance}}}};
}

Json RosDetectionJson(const vision_msgs_msg_dds__Detection3D_& detection) {
  const auto& size = detection.bbox.size;
  return {{"header", RosHeaderJson(detection.header)},
          {"results", Each(detection.results, RosResultJson)},
          {"bbox",
           {{"center", RosPoseJson(detection.bbox.center)}, {"size", {{"x", size.x}, {"y", size.y}, {"z", size.z}}}}},
          {"id", detection.id}};
}

}  // namespace

Json ToJson(const vision_msgs_msg_dds__Detection3DArray_& message) {
  return {{"topic", "detections"},
          {"header", RosHeaderJson(message.header)},
          {"detections", Each(message.detections, RosDetectionJson)}};
}

Json ToJson(const wirepose_Recognition& message) {
  return {{"topic", "recognition"},
          {"frame_sequence", message.frame_sequence},
          {"capture_time_ns", message.capture_time_ns},
          {"stamp_ns", message.stamp_ns},
          {"frame_id", message.frame_id},
          {"detections", Each(message.detections, DetectionJson)},
          {"lists", Each(message.lists, ListUseJson)},
          {"budget_hit", message.budget_hit},
          {"results_dropped", message.results_dropped}};
}

Json ToJson(const wirepose_Health& message) {
  const wirepose_FrameCounts& frames = message.frames;
  return {{"topic", "health"},
          {"state", StateName(message.state)},
          {"version", message.version},
          {"uptime_ns", message.uptime_ns},
          {"frames",
           {{"good", frames.good},
            {"missing", frames.missing},
            {"damaged", frames.damaged},
            {"not_synchronous", frames.not_synchronous},
            {"late", frames.late},
            {"failed", frames.failed}}},
          {"camera", message.camera},
          {"camera_status", message.camera_status},
          {"last_error", message.last_error},
          {"rows",
           {{"state", StateName(message.rows.state)},
            {"corners", message.rows.corners},
            {"median_px", message.rows.median_px},
            {"spread_px", message.rows.spread_px},
            {"steady_px", message.rows.steady_px},
            {"varying_px", message.rows.varying_px}}},
          {"stage_times",
           Each(message.stage_times,
                [](const wirepose_StageTime& time) {
                  return Json{
                      {"stage", time.stage}, {"p50_ns", time.p50_ns}, {"p99_ns", time.p99_ns}, {"max_ns", time.max_ns}};
                })},
          {"lists", Each(message.lists, ListUseJson)},
          {"queue_high_water", message.queue_high_water},
          {"queue_capacity", message.queue_capacity},
          {"results_dropped", message.results_dropped},
          {"write_errors", message.write_errors},
          {"pool",
           {{"used_bytes", message.pool.used_bytes},
            {"high_water_bytes", message.pool.high_water_bytes},
            {"capacity_bytes", message.pool.capacity_bytes}}},
          {"events",
           {{"subscribers", message.events.subscribers},
            {"deadlines_missed", message.events.deadlines_missed},
            {"incompatible_qos", message.events.incompatible_qos},
            {"commands_accepted", message.events.commands_accepted},
            {"commands_refused", message.events.commands_refused}}},
          {"models", Each(message.models, [](const wirepose_ModelStatus& model) {
             return Json{
                 {"id", model.id}, {"name", model.name}, {"checksum", model.checksum}, {"searched", model.searched}};
           })}};
}

Json ToJson(const wirepose_CommandStatus& message) {
  const wirepose_Region& region = message.region;
  return {
      {"topic", "command_status"},
      {"sender", message.sender},
      {"request_id", message.request_id},
      {"action", ActionName(message.action)},
      {"accepted", message.accepted},
      {"reason", message.reason},
      {"paused", message.paused},
      {"searched_ids", Each(message.searched_ids, [](std::uint32_t id) { return id; })},
      {"region",
       {{"x_px", region.x_px}, {"y_px", region.y_px}, {"width_px", region.width_px}, {"height_px", region.height_px}}}};
}

Json ToJson(const diagnostic_msgs_msg_dds__DiagnosticArray_& message) {
  const auto value = [](const diagnostic_msgs_msg_dds__KeyValue_& entry) {
    return Json{{"key", entry.key}, {"value", entry.value}};
  };
  return {{"topic", "diagnostics"},
          {"header", RosHeaderJson(message.header)},
          {"status", Each(message.status, [&](const diagnostic_msgs_msg_dds__DiagnosticStatus_& status) {
             return Json{{"level", status.level},
                         {"name", status.name},
                         {"message", status.message},
                         {"hardware_id", status.hardware_id},
                         {"values", Each(status.values, value)}};
           })}};
}

}  // namespace wirepose::cli
