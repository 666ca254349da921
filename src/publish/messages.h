// From reports to DDS messages: pure functions, no network.
#ifndef WIREPOSE_PUBLISH_MESSAGES_H_
#define WIREPOSE_PUBLISH_MESSAGES_H_

#include <array>
#include <string_view>

#include "dds_idl/diagnostic_msgs.h"
#include "dds_idl/sensor_msgs.h"
#include "dds_idl/vision_msgs.h"
#include "dds_idl/visualization_msgs.h"
#include "dds_idl/wirepose.h"
#include "publish/commands.h"
#include "publish/image_report.h"
#include "publish/loss_monitor.h"
#include "publish/reports.h"
#include "publish/scene_report.h"

namespace wirepose {

inline constexpr std::size_t kMaxLists = 8;  // bounded lists a message can report on; the recognizer has one fewer

// Of a scene: remove the old ones, all lines, and for each object wireframe, line set and label.
inline constexpr std::size_t kMaxMarkers = 2 + 3 * kMaxDetections;
inline constexpr std::size_t kDiagnosticStatuses = 4;
inline constexpr std::size_t kMaxDiagnosticValues = 32;

// The largest serialized message that the types' bounds allow, 4 bytes of header included, rounded up. Not part of the
// types: tests/publish/messages_test.cpp fills messages to their bounds and measures.
inline constexpr std::uint32_t kMaxDetectionsBytes = 32768;
inline constexpr std::uint32_t kMaxRecognitionBytes = 12288;
inline constexpr std::uint32_t kMaxHealthBytes = 4096;
inline constexpr std::uint32_t kMaxMarkersBytes = 65536;
inline constexpr std::uint32_t kMaxDiagnosticsBytes = 16384;
inline constexpr std::uint32_t kMaxImageBytes = 307456;
inline constexpr std::uint32_t kMaxCommandStatusBytes = 512;

// The messages with the storage of their bounded sequences. They point into themselves, hence are
// neither copied nor moved. Good for writing and for dds_take: the sequences never own their
// buffers.
class DetectionsMessage {
 public:
  DetectionsMessage();
  DetectionsMessage(const DetectionsMessage&) = delete;
  DetectionsMessage& operator=(const DetectionsMessage&) = delete;

  vision_msgs_msg_dds__Detection3DArray_ value{};

 private:
  std::array<vision_msgs_msg_dds__Detection3D_, kMaxDetections> detections_{};
  std::array<std::array<vision_msgs_msg_dds__ObjectHypothesisWithPose_, kMaxModes>, kMaxDetections> results_{};
};

class RecognitionMessage {
 public:
  RecognitionMessage();
  RecognitionMessage(const RecognitionMessage&) = delete;
  RecognitionMessage& operator=(const RecognitionMessage&) = delete;

  wirepose_Recognition value{};

 private:
  std::array<wirepose_Detection, kMaxDetections> detections_{};
  std::array<std::array<wirepose_PoseMode, kMaxModes>, kMaxDetections> modes_{};
  std::array<wirepose_ListUse, kMaxLists> lists_{};
};

class HealthMessage {
 public:
  HealthMessage();
  HealthMessage(const HealthMessage&) = delete;
  HealthMessage& operator=(const HealthMessage&) = delete;

  wirepose_Health value{};

 private:
  std::array<wirepose_StageTime, kStageCount + 1> stage_times_{};
  std::array<wirepose_ListUse, kMaxLists> lists_{};
  std::array<wirepose_ModelStatus, kMaxModels> models_{};
};

// For writing only: all markers share one buffer of points.
class MarkersMessage {
 public:
  MarkersMessage();
  MarkersMessage(const MarkersMessage&) = delete;
  MarkersMessage& operator=(const MarkersMessage&) = delete;

  visualization_msgs_msg_dds__MarkerArray_ value{};
  std::array<geometry_msgs_msg_dds__Point_, kMaxScenePoints> points{};

 private:
  std::array<visualization_msgs_msg_dds__Marker_, kMaxMarkers> markers_{};
};

class DiagnosticsMessage {
 public:
  DiagnosticsMessage();
  DiagnosticsMessage(const DiagnosticsMessage&) = delete;
  DiagnosticsMessage& operator=(const DiagnosticsMessage&) = delete;

  diagnostic_msgs_msg_dds__DiagnosticArray_ value{};

 private:
  std::array<diagnostic_msgs_msg_dds__DiagnosticStatus_, kDiagnosticStatuses> statuses_{};
  std::array<std::array<diagnostic_msgs_msg_dds__KeyValue_, kMaxDiagnosticValues>, kDiagnosticStatuses> values_{};
};

class CommandMessage {
 public:
  CommandMessage();
  CommandMessage(const CommandMessage&) = delete;
  CommandMessage& operator=(const CommandMessage&) = delete;

  wirepose_Command value{};

 private:
  std::array<std::uint32_t, kMaxModels> model_ids_{};
};

class CommandStatusMessage {
 public:
  CommandStatusMessage();
  CommandStatusMessage(const CommandStatusMessage&) = delete;
  CommandStatusMessage& operator=(const CommandStatusMessage&) = delete;

  wirepose_CommandStatus value{};

 private:
  std::array<std::uint32_t, kMaxModels> searched_ids_{};
};

// Unit quaternion (x, y, z, w) of a rotation matrix, in the half with w >= 0 (of two with w = 0,
// the one whose first non-zero component is positive): one rotation, one quaternion.
std::array<double, 4> QuaternionOf(const Matrix3d& R);

// Covariance as ROS orders it (geometry_msgs/PoseWithCovariance: x y z, rotation about fixed x y z;
// row-major) from that of Detection::covariance (rotation first). Both are about the model origin
// and in the camera frame, so only the order changes.
std::array<double, 36> RosCovariance(const Matrix6d& covariance);

// rt/wirepose/detections. A detection with modes has one result a mode, the heaviest first, score
// times weight; all modes share the covariance. class_id: model name; id: track id, empty when not
// tracked; bbox: the model's box at the pose of the detection.
void FillMessage(const FrameReport& report, std::string_view frame_id, DetectionsMessage& message);

// wirepose/recognition. Sets results_dropped to 0: only the publisher knows.
void FillMessage(const FrameReport& report, std::string_view frame_id, RecognitionMessage& message);

// wirepose/health. `version` is the program's.
void FillMessage(const HealthReport& report, std::string_view version, HealthMessage& message);

// rt/wirepose/markers: for RViz and Foxglove. First a marker that removes those of the frame before. Namespaces:
// "lines" (all 3D lines, grey), "wireframe", "line_set" and "label" with the object's number in the frame as id; an
// object's three have one colour.
void FillMessage(const SceneReport& scene, std::string_view frame_id, MarkersMessage& message);

// rt/wirepose/left/image_raw, mono8. The message points into the report, which must outlive its use.
void FillMessage(const ImageReport& image, std::string_view frame_id, sensor_msgs_msg_dds__Image_& message);

// rt/diagnostics: four statuses, "wireposed: camera", "... recognition", "... bus" and "... models", with level and
// values as robot monitors show them. Counters are since the start; losses raise a level while they are recent.
void FillMessage(const HealthReport& report, const RecentLosses& losses, DiagnosticsMessage& message);

// wirepose/command_status.
void FillMessage(const CommandAnswer& answer, CommandStatusMessage& message);
// The message as our own type. Any content is fine: who executes it decides.
Command ReadMessage(const wirepose_Command& message);

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_MESSAGES_H_
