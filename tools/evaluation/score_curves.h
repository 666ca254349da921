// What the score is worth: what a threshold on it gives, and whether it is the probability it claims to be.
#ifndef WIREPOSE_TOOLS_EVALUATION_SCORE_CURVES_H_
#define WIREPOSE_TOOLS_EVALUATION_SCORE_CURVES_H_

#include <span>
#include <vector>

#include "tools/evaluation/metrics.h"

namespace wirepose::evaluation {

// A detection that counts: right (a hit) or not. "Don't care" ones are none.
struct ScoredDetection {
  double score = 0;
  bool right = false;
};

// The detections of `estimates` that count, in their order. `metrics` are of the same estimates.
std::vector<ScoredDetection> CountedDetections(std::span<const Estimate> estimates, const Metrics& metrics);

// Detections with score >= threshold, judged as a run with that threshold would be.
struct CurvePoint {
  double threshold = 0;
  double precision = 0;
  double recall = 0;
};

// One point per distinct score, by falling threshold; empty without detections. `instances` > 0 or no recall is given
// (0). A hit stays a hit when weaker detections are left out, for matching goes by falling score. O(n log n).
std::vector<CurvePoint> ScoreCurve(std::vector<ScoredDetection> detections, int instances);

// Detections with a score in [low, high). The interval holds the true share with 95 % probability (Wilson, "Probable
// inference", 1927).
struct ReliabilityBin {
  double low = 0, high = 0;
  int count = 0;
  double mean_score = 0;  // as the next three, valid when count > 0
  double share_right = 0;
  double share_low = 0, share_high = 0;
};

struct Reliability {
  std::vector<ReliabilityBin> bins;  // ten of equal width over [0, 1]; the last one includes 1
  // Expected calibration error: mean over detections of |mean score - share right| of their bin (Naeini et al. 2015).
  // Empty without detections.
  std::optional<double> expected_error;
};

// Scores outside of [0, 1] count in the first or the last bin.
Reliability MeasureReliability(std::span<const ScoredDetection> detections);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_SCORE_CURVES_H_
