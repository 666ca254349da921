// Where the recognizer lost each object: follows every true instance through the stages.
#ifndef WIREPOSE_TOOLS_EVALUATION_STAGE_TRACE_H_
#define WIREPOSE_TOOLS_EVALUATION_STAGE_TRACE_H_

#include <optional>
#include <string_view>
#include <vector>

#include "hal/dataset/dataset.h"
#include "pipeline/recognizer.h"
#include "tools/evaluation/stage_clock.h"

namespace wirepose::evaluation {

// A pose that a stage produced, against one true instance.
struct TracedPose {
  double error_d = 9;    // largest vertex distance modulo symmetry, in diameters
  std::size_t rank = 0;  // 0 is the stage's best
  float score = 0;
};

// What each stage knew about one true instance. The traced pose of a stage is its nearest to the truth.
struct InstanceTrace {
  int object_id = 0;
  double visible_fraction = 0;
  double depth_m = 0;
  int visible_edges = 0;  // model edges that the camera could see, of 8 px or more
  int found_edges = 0;    // of these, half covered by a 2D segment within 3 px
  int deep_edges = 0;     // of these, by a 3D line whose disparities are within 1 px or 3 %
  TracedPose hypothesis, set, candidate;
  bool detected = false;
};

enum class MissCause { kNone, kNoLines, kNoHypothesis, kRankedOut, kWrongPose, kRejected };
std::string_view CauseName(MissCause cause);

// The first stage that lost it. A pose within reach of the next stage: 0.3 d of hypotheses, 0.2 d of sets, 0.1 d
// refined.
MissCause CauseOf(const InstanceTrace& trace);

// Observes Process on the caller's thread and passes every call on to `clock` (may be null), which does not time the
// tracing. Holds references; one frame at a time.
class StageTrace final : public StageObserver {
 public:
  StageTrace(const Recognizer& recognizer, StageClock* clock) : recognizer_(recognizer), clock_(clock) {}

  // Before Process: the frame's truth, poses in the raw left camera.
  void Start(const std::vector<dataset::TrueInstance>& truth);
  // After Process: completes the traces with what was reported. One per instance, in the order of the truth.
  const std::vector<InstanceTrace>& Finish(const RecognitionResult& result);

 private:
  void DoStageDone(Stage stage) override;
  void TraceLines();
  template <typename List, typename PoseOf>
  void TracePoses(const List& list, TracedPose InstanceTrace::*slot, const PoseOf& pose_of);

  const Recognizer& recognizer_;
  StageClock* clock_;
  const std::vector<dataset::TrueInstance>* truth_ = nullptr;
  std::vector<InstanceTrace> traces_;
  std::size_t models_seen_ = 0;
};

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_STAGE_TRACE_H_
