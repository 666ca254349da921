// rt/wirepose/markers.
#include <iterator>

#include "publish/message_parts.h"
#include "publish/messages.h"

namespace wirepose {
namespace {

static_assert(kMaxMarkers == 50 && kMaxScenePoints == 2048, "change the bounds in dds_idl/visualization_msgs.idl too");

// Of visualization_msgs/msg/Marker.
constexpr std::int32_t kLineList = 5, kTextViewFacing = 9;
constexpr std::int32_t kAdd = 0, kDeleteAll = 3;

constexpr double kLineWidth_m = 0.002, kWireframeWidth_m = 0.004, kTextHeight_m = 0.04;

using Marker = visualization_msgs_msg_dds__Marker_;
using Color = std_msgs_msg_dds__ColorRGBA_;

constexpr Color kGrey = {0.6F, 0.6F, 0.6F, 0.6F};
// Easily told apart, also by people who do not see red and green (Okabe and Ito's palette).
constexpr Color kObjectColors[] = {{0.90F, 0.62F, 0.00F, 1}, {0.34F, 0.71F, 0.91F, 1}, {0.00F, 0.62F, 0.45F, 1},
                                   {0.94F, 0.89F, 0.26F, 1}, {0.00F, 0.45F, 0.70F, 1}, {0.84F, 0.37F, 0.00F, 1},
                                   {0.80F, 0.47F, 0.65F, 1}};

class MarkerWriter {
 public:
  MarkerWriter(const SceneReport& scene, std::string_view frame_id, MarkersMessage& message)
      : header_(RosHeader(scene.stamp, frame_id)), message_(message) {
    message_.value.markers._length = 0;
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const ScenePoint& p = scene.points[i];
      message_.points[i] = {double{p.x}, double{p.y}, double{p.z}};
    }
  }

  Marker& Add(const char* name_space, std::size_t id, std::int32_t type, const Color& color) {
    auto& markers = message_.value.markers;
    Marker& marker = markers._buffer[markers._length++];
    marker = {};
    marker.header = header_;
    CopyText(name_space, marker.ns);
    marker.id = static_cast<std::int32_t>(id);
    marker.type = type;
    marker.action = kAdd;
    marker.pose.orientation.w = 1;
    marker.color = color;
    marker.points._release = false;
    return marker;
  }
  void AddLines(const char* name_space, std::size_t id, const SceneLines& lines, double width_m, const Color& color,
                const geometry_msgs_msg_dds__Pose_& pose) {
    if (lines.count == 0) return;  // RViz warns of a line list without points
    Marker& marker = Add(name_space, id, kLineList, color);
    marker.pose = pose;
    marker.scale.x = width_m;
    marker.points._buffer = message_.points.data() + lines.first;
    marker.points._length = marker.points._maximum = lines.count;
  }

 private:
  const std_msgs_msg_dds__Header_ header_;
  MarkersMessage& message_;
};

}  // namespace

MarkersMessage::MarkersMessage() { Attach(value.markers, markers_); }

void FillMessage(const SceneReport& scene, std::string_view frame_id, MarkersMessage& message) {
  const geometry_msgs_msg_dds__Pose_ camera = RosPose(Pose{});
  MarkerWriter writer(scene, frame_id, message);
  writer.Add("", 0, kLineList, {}).action = kDeleteAll;
  writer.AddLines("lines", 0, scene.lines, kLineWidth_m, kGrey, camera);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    const Color& color = kObjectColors[i % std::size(kObjectColors)];
    const geometry_msgs_msg_dds__Pose_ pose = RosPose(object.T_camera_model);
    writer.AddLines("wireframe", i, object.wireframe, kWireframeWidth_m, color, pose);
    writer.AddLines("line_set", i, object.line_set, 2 * kLineWidth_m, color, camera);
    Marker& label = writer.Add("label", i, kTextViewFacing, color);
    label.pose = pose;
    label.scale.z = kTextHeight_m;
    CopyText(object.label, label.text);
  }
}

}  // namespace wirepose
