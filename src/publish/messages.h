// From reports to DDS messages: pure functions, no network.
#ifndef WIREPOSE_PUBLISH_MESSAGES_H_
#define WIREPOSE_PUBLISH_MESSAGES_H_

#include <array>
#include <span>
#include <string_view>

#include "dds_idl/vision_msgs.h"
#include "dds_idl/wirepose.h"
#include "model/model_view.h"
#include "publish/reports.h"

namespace wirepose {

inline constexpr std::size_t kMaxLists = 8;  // bounded lists a message can report on; the recognizer has 7

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

// Unit quaternion (x, y, z, w) of a rotation matrix, in the half with w >= 0 (of two with w = 0,
// the one whose first non-zero component is positive): one rotation, one quaternion.
std::array<double, 4> QuaternionOf(const Matrix3d& R);

// Covariance as ROS orders it (geometry_msgs/PoseWithCovariance: x y z, rotation about fixed x y z;
// row-major) from that of Detection::covariance (rotation first). Both are about the model origin
// and in the camera frame, so only the order changes.
std::array<double, 36> RosCovariance(const Matrix6d& covariance);

// rt/wirepose/detections. A detection with modes has one result a mode, the heaviest first, score
// times weight; all modes share the covariance. class_id: model name; id: track id, empty when not
// tracked; bbox: the model's box at the pose of the detection. header.stamp is the capture time.
// `models` names what was searched for.
void FillMessage(const FrameReport& report, std::span<const ModelView> models, std::string_view frame_id,
                 DetectionsMessage& message);

// wirepose/recognition.
void FillMessage(const FrameReport& report, std::span<const ModelView> models, std::string_view frame_id,
                 RecognitionMessage& message);

// wirepose/health. `version` is the program's.
void FillMessage(const HealthReport& report, std::span<const ModelView> models, std::string_view version,
                 HealthMessage& message);

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_MESSAGES_H_
