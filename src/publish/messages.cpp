#include "publish/messages.h"

#include <algorithm>
#include <charconv>
#include <iterator>

#include "publish/message_parts.h"

namespace wirepose {
namespace {

// Bounds of the IDL files, which cannot see capacities.h.
static_assert(kMaxDetections == 16 && kMaxModes == 4 && kMaxModels == 32 && kMaxModelName == 32 && kStageCount == 9,
              "change the bounds in dds_idl/*.idl too");

const ModelLabel* FindModel(const ModelLabels& models, std::uint32_t id) {
  const auto* const found =
      std::find_if(models.begin(), models.end(), [id](const ModelLabel& model) { return model.id == id; });
  return found == models.end() ? nullptr : found;
}

// The decimal number as text.
FixedText<32> TextOf(std::uint32_t number) {
  char digits[16];
  const std::to_chars_result end = std::to_chars(std::begin(digits), std::end(digits), number);
  return std::string_view(digits, static_cast<std::size_t>(end.ptr - digits));
}

// A nameless model is called by its number.
FixedText<32> ModelName(const ModelLabels& models, std::uint32_t id) {
  const ModelLabel* const model = FindModel(models, id);
  return model == nullptr || model->name == "" ? TextOf(id) : model->name;
}

wirepose_Pose NativePose(const Pose& T) {
  const std::array<double, 4> q = QuaternionOf(T.R);
  return {{T.t.x(), T.t.y(), T.t.z()}, {q[0], q[1], q[2], q[3]}};
}

vision_msgs_msg_dds__BoundingBox3D_ Box(const Pose& T, const ModelLabel* model) {
  if (model == nullptr) return {RosPose(T), {0, 0, 0}};
  const Vector3d low = model->box_min_m.cast<double>();
  const Vector3d high = model->box_max_m.cast<double>();
  const Vector3d size = high - low;
  return {RosPose({T.R, T * (0.5 * (low + high))}), {size.x(), size.y(), size.z()}};
}

// Heaviest first; a single mode of weight 1 when the pose is unambiguous.
FixedVector<PoseMode, kMaxModes> ModesOf(const Detection& detection) {
  FixedVector<PoseMode, kMaxModes> modes = detection.modes;
  if (modes.empty()) modes.push_back({detection.T_camera_model, 1.0F});
  // Insertion sort: stable without the heap that std::stable_sort uses.
  for (PoseMode* i = modes.begin(); i != modes.end(); ++i) {
    PoseMode* const place = std::upper_bound(modes.begin(), i, *i,
                                             [](const PoseMode& a, const PoseMode& b) { return a.weight > b.weight; });
    std::rotate(place, i, i + 1);
  }
  return modes;
}

void FillRosDetection(const Detection& detection, const ModelLabels& models, const std_msgs_msg_dds__Header_& header,
                      vision_msgs_msg_dds__Detection3D_& out) {
  const FixedText<32> name = ModelName(models, detection.model_id);
  const std::array<double, 36> covariance = RosCovariance(detection.covariance);
  out.header = header;
  out.results._length = 0;
  for (const PoseMode& mode : ModesOf(detection)) {
    auto& result = out.results._buffer[out.results._length++];
    CopyText(name, result.hypothesis.class_id);
    result.hypothesis.score = double{detection.score} * double{mode.weight};
    result.pose.pose = RosPose(mode.T_camera_model);
    std::copy(covariance.begin(), covariance.end(), result.pose.covariance);
  }
  out.bbox = Box(detection.T_camera_model, FindModel(models, detection.model_id));
  CopyText(detection.track_id == 0 ? FixedText<32>() : TextOf(detection.track_id), out.id);
}

void FillNativeDetection(const Detection& detection, const ModelLabels& models, wirepose_Detection& out) {
  const std::array<double, 36> covariance = RosCovariance(detection.covariance);
  out.model_id = detection.model_id;
  CopyText(ModelName(models, detection.model_id), out.name);
  out.pose = NativePose(detection.T_camera_model);
  std::copy(covariance.begin(), covariance.end(), out.covariance);
  out.score = detection.score;
  out.visible_fraction = detection.visible_fraction;
  out.track_id = detection.track_id;
  out.modes._length = 0;
  for (const PoseMode& mode : detection.modes) {
    out.modes._buffer[out.modes._length++] = {NativePose(mode.T_camera_model), mode.weight};
  }
}

void FillLists(const RecognitionStatistics& statistics, dds_sequence_wirepose_ListUse& out) {
  static_assert(kRecognitionLists.size() <= kMaxLists);
  out._length = 0;
  for (const auto& [name, member] : kRecognitionLists) {
    const ListUse& use = statistics.*member;
    wirepose_ListUse& entry = out._buffer[out._length++];
    CopyText(name, entry.name);
    entry.used = use.used;
    entry.capacity = use.capacity;
    entry.dropped = use.dropped;
  }
}

// Pool sizes are far below 4 GiB.
std::uint32_t Narrow(std::size_t bytes) { return static_cast<std::uint32_t>(bytes); }

wirepose_HealthState NativeState(HealthState state) {
  switch (state) {
    case HealthState::kStarting:
      return wirepose_STARTING;
    case HealthState::kRunning:
      return wirepose_RUNNING;
    case HealthState::kBadFrames:
      return wirepose_BAD_FRAMES;
    case HealthState::kNoFrames:
      return wirepose_NO_FRAMES;
    case HealthState::kCameraLost:
      return wirepose_CAMERA_LOST;
    case HealthState::kPaused:
      return wirepose_PAUSED;
    case HealthState::kStopped:
      return wirepose_STOPPED;
  }
  return wirepose_STARTING;
}

wirepose_RowState NativeState(RowState state) {
  switch (state) {
    case RowState::kUnknown:
      return wirepose_ROWS_UNKNOWN;
    case RowState::kAligned:
      return wirepose_ROWS_ALIGNED;
    case RowState::kSteadyOffset:
      return wirepose_ROWS_STEADILY_OFF;
    case RowState::kVaryingOffset:
      return wirepose_ROWS_VARYINGLY_OFF;
  }
  return wirepose_ROWS_UNKNOWN;
}

}  // namespace

const char* Describe(HealthState state) {
  switch (state) {
    case HealthState::kStarting:
      return "starting";
    case HealthState::kRunning:
      return "running";
    case HealthState::kBadFrames:
      return "bad_frames";
    case HealthState::kNoFrames:
      return "no_frames";
    case HealthState::kCameraLost:
      return "camera_lost";
    case HealthState::kPaused:
      return "paused";
    case HealthState::kStopped:
      return "stopped";
  }
  return "?";
}

DetectionsMessage::DetectionsMessage() {
  Attach(value.detections, detections_);
  for (std::size_t i = 0; i < kMaxDetections; ++i) Attach(detections_[i].results, results_[i]);
}

RecognitionMessage::RecognitionMessage() {
  Attach(value.detections, detections_);
  for (std::size_t i = 0; i < kMaxDetections; ++i) Attach(detections_[i].modes, modes_[i]);
  Attach(value.lists, lists_);
}

HealthMessage::HealthMessage() {
  Attach(value.stage_times, stage_times_);
  Attach(value.lists, lists_);
  Attach(value.models, models_);
}

std::array<double, 4> QuaternionOf(const Matrix3d& R) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(Orthonormalize(R)).normalized();
  std::array<double, 4> out = {q.x(), q.y(), q.z(), q.w()};
  double sign = q.w();
  for (std::size_t i = 0; sign == 0 && i < 3; ++i) sign = out[i];
  // Adding 0 turns -0 into 0: equal rotations shall have equal bytes.
  for (double& component : out) component = (sign < 0 ? -component : component) + 0.0;
  return out;
}

std::array<double, 36> RosCovariance(const Matrix6d& covariance) {
  constexpr Eigen::Index kOurs[6] = {3, 4, 5, 0, 1, 2};  // where ROS's x y z rx ry rz stand in ours
  std::array<double, 36> out{};
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 6; ++column) {
      out[6 * row + column] = covariance(kOurs[row], kOurs[column]);
    }
  }
  return out;
}

void FillMessage(const FrameReport& report, std::string_view frame_id, DetectionsMessage& message) {
  message.value.header = RosHeader(report.stamp, frame_id);
  auto& out = message.value.detections;
  out._length = 0;
  for (const Detection& detection : report.result.detections) {
    FillRosDetection(detection, report.models, message.value.header, out._buffer[out._length++]);
  }
}

void FillMessage(const FrameReport& report, std::string_view frame_id, RecognitionMessage& message) {
  message.value.frame_sequence = report.sequence;
  message.value.capture_time_ns = report.capture_time.time_since_epoch().count();
  message.value.stamp_ns = report.stamp.count();
  CopyText(frame_id, message.value.frame_id);
  auto& out = message.value.detections;
  out._length = 0;
  for (const Detection& detection : report.result.detections) {
    FillNativeDetection(detection, report.models, out._buffer[out._length++]);
  }
  FillLists(report.result.statistics, message.value.lists);
  message.value.budget_hit = report.result.budget_hit;
  message.value.results_dropped = 0;
}

void FillMessage(const HealthReport& report, std::string_view version, HealthMessage& message) {
  wirepose_Health& out = message.value;
  out.state = NativeState(report.state);
  CopyText(version, out.version);
  out.uptime_ns = report.uptime_ns;
  const FrameCounts& frames = report.frames;
  out.frames = {frames.good, frames.missing, frames.damaged, frames.not_synchronous, frames.late, frames.failed};
  CopyText(report.camera, out.camera);
  CopyText(report.camera_status, out.camera_status);
  CopyText(report.last_error, out.last_error);
  const RowAlignment& rows = report.rows;
  out.rows = {NativeState(rows.state), rows.corners, rows.median_px, rows.spread_px, rows.steady_px, rows.varying_px};
  out.stage_times._length = 0;
  for (const StageTime& time : report.stage_times) {
    wirepose_StageTime& entry = out.stage_times._buffer[out.stage_times._length++];
    CopyText(time.stage, entry.stage);
    entry.p50_ns = time.p50_ns;
    entry.p99_ns = time.p99_ns;
    entry.max_ns = time.max_ns;
  }
  FillLists(report.lists, out.lists);
  out.queue_high_water = report.queue_high_water;
  out.queue_capacity = report.queue_capacity;
  out.results_dropped = report.results_dropped;
  out.write_errors = report.write_errors;
  out.pool = {Narrow(report.pool.used), Narrow(report.pool.high_water), Narrow(report.pool.capacity)};
  const BusEvents& events = report.events;
  out.events = {events.subscribers, events.deadlines_missed, events.incompatible_qos, events.commands_accepted,
                events.commands_refused};
  out.models._length = 0;
  for (const ModelLabel& model : report.models) {
    wirepose_ModelStatus& entry = out.models._buffer[out.models._length++];
    entry.id = model.id;
    CopyText(model.name, entry.name);
    entry.checksum = model.checksum;
    entry.searched = model.searched;
  }
}

}  // namespace wirepose
