// Detections against truth: recall, precision, accuracy and false alarms as bop_toolkit defines
// them.
//
// A detection is a true positive when its MSSD to a not yet matched instance of its object in its
// frame is below 0.1 of the diameter. Detections are taken by falling score and matched one to one,
// each to the nearest free instance. Instances below `min_visible_fraction` are "don't care": a
// detection matched to one counts neither way.
#ifndef WIREPOSE_TOOLS_EVALUATION_METRICS_H_
#define WIREPOSE_TOOLS_EVALUATION_METRICS_H_

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/evaluation/ground_truth.h"

namespace wirepose::evaluation {

// One row of a BOP results file, with the covariance where it is known.
struct Estimate {
  int scene_id = 0;
  int image_id = 0;
  int object_id = 0;
  double score = 0;
  RigidMm T_camera_model;              // raw left camera
  double time_s = -1;                  // of the whole frame; negative: not measured
  std::optional<Matrix6d> covariance;  // as Detection::covariance; rad and m
};

struct MetricsOptions {
  double min_visible_fraction = 0.4;
};

inline constexpr double kHitShareOfDiameter = 0.1;
inline constexpr std::size_t kThresholdCount = 10;  // MSSD 0.05..0.5 d, MSPD 5..50 px * width / 640
inline constexpr std::array<std::array<double, 2>, 3> kVisibilityBins{{{0.4, 0.6}, {0.6, 0.8}, {0.8, 1.0001}}};

struct HitCount {
  int instances = 0;
  int hits = 0;
  // Empty without instances.
  [[nodiscard]] std::optional<double> Recall() const;
};

// Counts of one object, or of all; the rates are derived from them.
struct ObjectScore {
  HitCount all;
  int false_positives = 0;
  int dont_care = 0;
  std::array<HitCount, kVisibilityBins.size()> by_visibility;
  std::vector<double> translation_errors_mm;  // of the true positives, as the next
  std::vector<double> rotation_errors_deg;
  std::array<int, kThresholdCount> mssd_hits{};
  std::array<int, kThresholdCount> mspd_hits{};
  std::vector<double> normalized_errors_squared;  // of the true positives with covariance, without
                                                  // continuous symmetry

  [[nodiscard]] std::optional<double> Precision() const;
  [[nodiscard]] std::optional<double> AverageRecallMssd() const;
  [[nodiscard]] std::optional<double> AverageRecallMspd() const;
  void Add(const ObjectScore& other);
};

// What became of one instance that counts.
struct InstanceOutcome {
  int scene_id = 0;
  int image_id = 0;
  int object_id = 0;
  std::size_t instance = 0;  // index into the frame's FrameTruth::instances, the order of the data set's file
  double visible_fraction = 1;
  RigidMm truth;  // of its symmetric poses the one nearest to the hit
  bool hit = false;
  RigidMm estimate;  // of the hit; as the three below only valid when `hit`
  double score = 0;
  double translation_mm = 0;
  double rotation_deg = 0;
  std::optional<double> best_mssd_mm;  // of all detections of the object in the frame, or of the hit; empty: none
};

struct FalsePositive {
  int scene_id = 0;
  int image_id = 0;
  int object_id = 0;
  double score = 0;
  Vector3d t_mm = Vector3d::Zero();
};

// What became of one estimate.
enum class Verdict : std::uint8_t { kHit, kFalse, kDontCare, kUnknownFrame };
struct Judgement {
  Verdict verdict = Verdict::kUnknownFrame;
  std::size_t instance = 0;  // as in InstanceOutcome; valid for kHit and kDontCare
};

// Times of the frames that have at least one row, seconds.
struct RowTimes {
  int frames = 0;
  std::optional<double> median_s, p99_s, max_s;
};

struct Metrics {
  int frames = 0;
  int negative_frames = 0;  // without any instance
  int negative_false_positives = 0;
  int rows = 0;
  MetricsOptions options;
  RowTimes time;
  std::map<int, ObjectScore> per_object;
  std::map<int, HitCount> per_scene;  // scenes with an instance that counts
  ObjectScore total;
  std::vector<InstanceOutcome> instances;
  std::vector<FalsePositive> false_positives;
  std::vector<Judgement> judgements;  // one per estimate, in the order given
};

// Rows that name frames which the truth does not have are counted in `rows` and otherwise ignored.
Metrics ComputeMetrics(const GroundTruth& truth, std::span<const Estimate> estimates,
                       const MetricsOptions& options = {});

// Linear interpolation between order statistics, as numpy.percentile; empty without values. `share`
// in [0, 1].
std::optional<double> Percentile(std::vector<double> values, double share);

// For each detection, in the given order, the instance it takes: the nearest free one with error <
// threshold, those that count before those that do not. errors[i][j] of detection i to instance j;
// `counts[j]` false: don't care.
std::vector<std::optional<std::size_t>> MatchGreedily(const std::vector<std::vector<double>>& errors, double threshold,
                                                      const std::vector<bool>& counts);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_METRICS_H_
