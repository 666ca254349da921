// Runs the recognizer over a data set and judges what it says.
#ifndef WIREPOSE_TOOLS_EVALUATION_EVALUATE_H_
#define WIREPOSE_TOOLS_EVALUATION_EVALUATE_H_

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "hal/dataset/dataset.h"
#include "pipeline/recognizer.h"
#include "pipeline/tracker.h"
#include "tools/evaluation/metrics.h"
#include "tools/evaluation/model_set.h"
#include "tools/evaluation/stage_clock.h"
#include "tools/evaluation/stage_trace.h"

namespace wirepose::evaluation {

struct EvaluationOptions {
  std::filesystem::path dataset;
  std::filesystem::path models;  // .wpm file or folder; empty: compile DATASET/models
  std::vector<int> object_ids;   // search only for these; empty: for all
  std::size_t frame_limit = 0;   // the first so many frames, and judge by them alone; 0: all
  std::filesystem::path pairs;   // corresponding pairs and whether they are right, as CSV; empty: not written
  std::filesystem::path sets;    // promoted line sets with their evidence, as CSV; empty: not written
  bool trace = false;            // follow the true instances through the stages
  bool track = false;            // follow objects over the frames of a scene, as wireposed does; else single frames
  double rate_hz = 30;           // of the frames when they are tracked: image ids count frames
  double min_score = 0;          // detections below are dropped before anything else looks at them
};

struct FrameRecord {
  int scene_id = 0;
  int image_id = 0;
  std::size_t detections = 0;  // kept ones
  bool budget_hit = false;
  FrameTimes times;
  RecognitionStatistics statistics;
};

struct Evaluation {
  std::vector<Estimate> estimates;  // by frame, then falling score
  std::vector<FrameRecord> frames;
  GroundTruth truth;  // of the frames judged
  Metrics metrics;
};

// What an observer may look at after each frame, valid during the call.
struct FrameView {
  std::size_t index = 0;  // of `count` frames
  std::size_t count = 0;
  const dataset::FrameEntry& entry;
  const Recognizer& recognizer;  // with its intermediates of this frame
  const ModelSet& models;
  const RecognitionResult& result;           // all detections, also those below min_score
  const std::vector<InstanceTrace>& traces;  // one per true instance; without poses unless options.trace
};
using FrameObserver = std::function<Result<void, std::string>(const FrameView&)>;

// A detection as a row of a results file: metres become millimetres, the frame is the same.
Estimate ToEstimate(const Detection& detection, const dataset::FrameEntry& entry, double time_s);

// Processes the frames in order, each once, with the one static Recognizer of this function: not
// reentrant. Stops at the first error, one line that names file, place and remedy: calibration,
// model, image or truth missing or malformed, an image that is not of the calibrated size, a model
// id that the data set does not know, or the observer's own. `observer` may be empty.
Result<Evaluation, std::string> Evaluate(const EvaluationOptions& options, const FrameObserver& observer);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_EVALUATE_H_
