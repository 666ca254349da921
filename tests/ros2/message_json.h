// The ROS messages as JSON with ROS's field names, straight from the C structs.
#ifndef WIREPOSE_TESTS_ROS2_MESSAGE_JSON_H_
#define WIREPOSE_TESTS_ROS2_MESSAGE_JSON_H_

#include <nlohmann/json.hpp>
#include <span>

#include "publish/messages.h"

namespace wirepose::test {

using Json = nlohmann::ordered_json;

template <typename Sequence, typename F>
Json EachOf(const Sequence& sequence, F f) {
  Json array = Json::array();
  for (const auto& element : std::span(sequence._buffer, sequence._length)) array.push_back(f(element));
  return array;
}

inline Json HeaderJson(const std_msgs_msg_dds__Header_& header) {
  return {{"stamp", {{"sec", header.stamp.sec}, {"nanosec", header.stamp.nanosec}}}, {"frame_id", header.frame_id}};
}

template <typename Vector>
Json VectorJson(const Vector& v) {
  return {{"x", v.x}, {"y", v.y}, {"z", v.z}};
}

inline Json PoseJson(const geometry_msgs_msg_dds__Pose_& pose) {
  const auto& q = pose.orientation;
  return {{"position", VectorJson(pose.position)},
          {"orientation", {{"x", q.x}, {"y", q.y}, {"z", q.z}, {"w", q.w}}}};
}

inline Json ColorJson(const std_msgs_msg_dds__ColorRGBA_& color) {
  return {{"r", color.r}, {"g", color.g}, {"b", color.b}, {"a", color.a}};
}

inline Json RosJson(const vision_msgs_msg_dds__Detection3DArray_& message) {
  const auto result = [](const vision_msgs_msg_dds__ObjectHypothesisWithPose_& r) -> Json {
    return {{"hypothesis", {{"class_id", r.hypothesis.class_id}, {"score", r.hypothesis.score}}},
            {"pose", {{"pose", PoseJson(r.pose.pose)}, {"covariance", r.pose.covariance}}}};
  };
  const auto detection = [&](const vision_msgs_msg_dds__Detection3D_& d) -> Json {
    return {{"header", HeaderJson(d.header)},
            {"results", EachOf(d.results, result)},
            {"bbox", {{"center", PoseJson(d.bbox.center)}, {"size", VectorJson(d.bbox.size)}}},
            {"id", d.id}};
  };
  return {{"header", HeaderJson(message.header)}, {"detections", EachOf(message.detections, detection)}};
}

inline Json RosJson(const visualization_msgs_msg_dds__MarkerArray_& message) {
  const auto marker = [](const visualization_msgs_msg_dds__Marker_& m) -> Json {
    const Json nothing = Json::array();
    return {{"header", HeaderJson(m.header)},
            {"ns", m.ns},
            {"id", m.id},
            {"type", m.type},
            {"action", m.action},
            {"pose", PoseJson(m.pose)},
            {"scale", VectorJson(m.scale)},
            {"color", ColorJson(m.color)},
            {"lifetime", {{"sec", m.lifetime.sec}, {"nanosec", m.lifetime.nanosec}}},
            {"frame_locked", m.frame_locked},
            {"points", EachOf(m.points, [](const auto& p) { return VectorJson(p); })},
            {"colors", nothing},
            {"texture_resource", ""},
            {"texture", {{"header", HeaderJson(m.texture.header)}, {"format", ""}, {"data", nothing}}},
            {"uv_coordinates", nothing},
            {"text", m.text},
            {"mesh_resource", ""},
            {"mesh_file", {{"filename", ""}, {"data", nothing}}},
            {"mesh_use_embedded_materials", m.mesh_use_embedded_materials}};
  };
  return {{"markers", EachOf(message.markers, marker)}};
}

inline Json RosJson(const diagnostic_msgs_msg_dds__DiagnosticArray_& message) {
  const auto value = [](const diagnostic_msgs_msg_dds__KeyValue_& v) -> Json {
    return {{"key", v.key}, {"value", v.value}};
  };
  const auto status = [&](const diagnostic_msgs_msg_dds__DiagnosticStatus_& s) -> Json {
    return {{"level", s.level},
            {"name", s.name},
            {"message", s.message},
            {"hardware_id", s.hardware_id},
            {"values", EachOf(s.values, value)}};
  };
  return {{"header", HeaderJson(message.header)}, {"status", EachOf(message.status, status)}};
}

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_ROS2_MESSAGE_JSON_H_
