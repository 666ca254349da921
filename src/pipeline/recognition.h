// What the recognizer says about one frame.
#ifndef WIREPOSE_PIPELINE_RECOGNITION_H_
#define WIREPOSE_PIPELINE_RECOGNITION_H_

#include <array>
#include <cstdint>

#include "base/fixed_vector.h"
#include "capacities.h"
#include "geometry/se3.h"

namespace wirepose {

// A pose that the visible evidence cannot tell from the others of the same detection.
struct PoseMode {
  Pose T_camera_model;
  float weight = 0;  // of all modes of a detection: 1 together
};

// One known object found in the frame.
struct Detection {
  std::uint32_t model_id = 0;
  // Model frame to the raw (unrectified) left camera's optical frame: x right, y down, z forward; metres.
  Pose T_camera_model;
  // Of the twist (rotation [rad], translation [m]) in the camera frame about the model origin: a true pose is
  // exp(rotation) * R, t + translation. Order rx ry rz tx ty tz. Symmetric positive definite.
  Matrix6d covariance = Matrix6d::Identity();
  float score = 0;                         // probability in [0, 1] that object and pose are right
  float visible_fraction = 0;              // supported length over the length of all edges that face the camera, 0..1
  std::uint32_t track_id = 0;              // 0: not tracked
  float existence = 0;                     // of a tracked object: probability that it exists, by all frames so far
  FixedVector<PoseMode, kMaxModes> modes;  // T_camera_model and others, heaviest first; empty: unambiguous
};

// Where an object may be, by what is known besides the frame: a pose to start from, which the frame must confirm.
struct PosePrior {
  std::uint32_t model_id = 0;
  Pose T_camera_model;  // to the raw left camera, m
};

// The stages in the order in which they run; names the stage times in health and evaluation.
enum class Stage : std::uint8_t {
  kRectify,
  kSegments,
  kStereoLines,
  kLineSets,
  kCorrespondences,
  kHypotheses,
  kVerify,
  kRefine,
  kSelect,
};
inline constexpr std::size_t kStageCount = 9;

// Lower case, as in messages and JSON: "rectify" ... "select".
const char* StageName(Stage stage);

// How full each bounded list was in this frame, and what did not fit: (used, dropped).
struct ListUse {
  std::uint32_t used = 0;
  std::uint32_t capacity = 0;
  std::uint32_t dropped = 0;  // worst elements given up because the list was full
};

struct RecognitionStatistics {
  ListUse edge_pixels;  // on ridges: of the eye that has more; dropped in both
  ListUse left_segments, lines, line_sets, correspondences, hypotheses;
  ListUse promoted;  // used: line sets that are ranked; dropped: hypotheses of poses beyond those promoted
  ListUse detections;
};

// Every list of the statistics by its name in messages and files, in the order of the stages.
struct RecognitionList {
  const char* name;
  ListUse RecognitionStatistics::*use;
};
inline constexpr std::array<RecognitionList, 8> kRecognitionLists = {{
    {"edge_pixels", &RecognitionStatistics::edge_pixels},
    {"left_segments", &RecognitionStatistics::left_segments},
    {"lines", &RecognitionStatistics::lines},
    {"line_sets", &RecognitionStatistics::line_sets},
    {"correspondences", &RecognitionStatistics::correspondences},
    {"hypotheses", &RecognitionStatistics::hypotheses},
    {"promoted", &RecognitionStatistics::promoted},
    {"detections", &RecognitionStatistics::detections},
}};
static_assert(sizeof(RecognitionStatistics) == kRecognitionLists.size() * sizeof(ListUse), "a list is missing above");

struct RecognitionResult {
  FixedVector<Detection, kMaxDetections> detections;  // by falling score
  RecognitionStatistics statistics;
  bool budget_hit = false;  // a bounded search stopped at its limit; the result is the best found by then
};

}  // namespace wirepose

#endif  // WIREPOSE_PIPELINE_RECOGNITION_H_
