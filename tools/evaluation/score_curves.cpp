#include "tools/evaluation/score_curves.h"

#include <algorithm>
#include <cmath>

namespace wirepose::evaluation {
namespace {

constexpr int kBins = 10;
constexpr double kNormalQuantile95 = 1.959963984540054;

void SetInterval(ReliabilityBin& bin) {
  const double n = bin.count, z2 = kNormalQuantile95 * kNormalQuantile95;
  const double middle = (bin.share_right + z2 / (2 * n)) / (1 + z2 / n);
  const double variance = bin.share_right * (1 - bin.share_right) / n + z2 / (4 * n * n);
  const double half = kNormalQuantile95 * std::sqrt(variance) / (1 + z2 / n);
  bin.share_low = std::max(0.0, middle - half);
  bin.share_high = std::min(1.0, middle + half);
}

}  // namespace

std::vector<ScoredDetection> CountedDetections(std::span<const Estimate> estimates, const Metrics& metrics) {
  std::vector<ScoredDetection> counted;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const Verdict verdict = metrics.judgements[i].verdict;
    if (verdict != Verdict::kHit && verdict != Verdict::kFalse) continue;
    counted.push_back({estimates[i].score, verdict == Verdict::kHit});
  }
  return counted;
}

std::vector<CurvePoint> ScoreCurve(std::vector<ScoredDetection> detections, int instances) {
  std::ranges::sort(detections, std::greater<>{}, &ScoredDetection::score);
  std::vector<CurvePoint> curve;
  int right = 0;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    right += detections[i].right;
    if (i + 1 < detections.size() && detections[i + 1].score == detections[i].score) continue;
    const double recall = instances > 0 ? static_cast<double>(right) / instances : 0;
    curve.push_back({detections[i].score, right / static_cast<double>(i + 1), recall});
  }
  return curve;
}

Reliability MeasureReliability(std::span<const ScoredDetection> detections) {
  Reliability reliability;
  reliability.bins.resize(kBins);
  for (int b = 0; b < kBins; ++b) {
    ReliabilityBin& bin = reliability.bins[static_cast<std::size_t>(b)];
    bin.low = static_cast<double>(b) / kBins;
    bin.high = static_cast<double>(b + 1) / kBins;
  }
  for (const ScoredDetection& d : detections) {
    const double place = std::clamp(std::floor(d.score * kBins), 0.0, kBins - 1.0);
    ReliabilityBin& bin = reliability.bins[static_cast<std::size_t>(place)];
    ++bin.count;
    bin.mean_score += d.score;
    bin.share_right += d.right ? 1 : 0;
  }
  double error = 0;
  for (ReliabilityBin& bin : reliability.bins) {
    if (bin.count == 0) continue;
    bin.mean_score /= bin.count;
    bin.share_right /= bin.count;
    SetInterval(bin);
    error += bin.count * std::abs(bin.mean_score - bin.share_right);
  }
  if (!detections.empty()) reliability.expected_error = error / static_cast<double>(detections.size());
  return reliability;
}

}  // namespace wirepose::evaluation
