// What the robot program tells the world: one report a frame, one on its health once a second.
// Plain data, no DDS.
#ifndef WIREPOSE_PUBLISH_REPORTS_H_
#define WIREPOSE_PUBLISH_REPORTS_H_

#include <cstdint>
#include <span>

#include "base/fixed_vector.h"
#include "base/time.h"
#include "model/model_view.h"
#include "pipeline/recognition.h"
#include "pipeline/row_alignment.h"
#include "publish/fixed_heap.h"
#include "publish/fixed_text.h"

namespace wirepose {

// What messages say of a model that is loaded.
struct ModelLabel {
  std::uint32_t id = 0;
  std::uint32_t checksum = 0;
  FixedText<kMaxModelName> name;
  Vector3 box_min_m = Vector3::Zero(), box_max_m = Vector3::Zero();  // model frame
  bool searched = true;
};
using ModelLabels = FixedVector<ModelLabel, kMaxModels>;

// The labels of models; bit i of `searched`: models[i] is searched for.
ModelLabels LabelsOf(std::span<const ModelView> models, std::uint32_t searched);

// One good frame and what was recognized in it.
struct FrameReport {
  std::uint64_t sequence = 0;
  CaptureTime capture_time{};
  std::chrono::nanoseconds stamp{0};  // the same moment for header.stamp of the ROS messages
  ModelLabels models;
  RecognitionResult result;
};

// Where the program stands.
enum class HealthState : std::uint8_t {
  kStarting,    // before the first frame
  kRunning,     // the last frame was good
  kBadFrames,   // frames arrive, but the last one could not be used
  kNoFrames,    // the camera is there, no frame within the time-out
  kCameraLost,  // the camera is gone; the program tries again
  kStopped,     // ended in order; the last message
  kPaused,      // by command: frames are taken, nothing is recognized
};
const char* Describe(HealthState state);

struct FrameCounts {
  std::uint64_t good = 0;
  std::uint64_t missing = 0;          // arrived without image
  std::uint64_t damaged = 0;          // arrived with pixels that cannot be trusted
  std::uint64_t not_synchronous = 0;  // left and right exposed at different times
  std::uint64_t late = 0;             // lost before they reached us: gaps in the sequence
  std::uint64_t failed = 0;           // good frames that the recognizer refused
};

struct StageTime {
  FixedText<32> stage;
  std::uint64_t p50_ns = 0, p99_ns = 0, max_ns = 0;
};

// Every stage and the whole frame.
using StageTimes = FixedVector<StageTime, kStageCount + 1>;

// What happened to writers and readers since the start; `subscribers` is now.
struct BusEvents {
  std::uint32_t subscribers = 0;
  std::uint32_t deadlines_missed = 0;
  std::uint32_t incompatible_qos = 0;
  std::uint32_t commands_accepted = 0, commands_refused = 0;
};

struct HealthReport {
  HealthState state = HealthState::kStarting;
  std::uint64_t uptime_ns = 0;
  std::chrono::nanoseconds stamp{0};  // of the report, for header.stamp
  FrameCounts frames;
  FixedText<32> camera;         // backend
  FixedText<64> camera_status;  // "ok", or what is wrong now
  FixedText<256> last_error;    // empty: none since the start
  RowAlignment rows;
  StageTimes stage_times;
  RecognitionStatistics lists;  // highest use and sum of drops since the start
  std::uint32_t queue_high_water = 0, queue_capacity = 0;
  std::uint64_t results_dropped = 0, write_errors = 0;
  HeapUse pool;  // of DDS
  BusEvents events;
  ModelLabels models;
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_REPORTS_H_
