#include "stages/edge_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "stages/edge_summary.h"
#include "stages/edge_sums.h"

namespace wirepose {
namespace {

using Peaks = FixedVector<EdgePeak, 2 * EdgeProfile::kMaxRange>;

void CollectPeaks(const EdgeProfile& profile, float threshold, Peaks& peaks) {
  peaks.clear();
  profile.ForEachPeak(threshold, [&](const EdgePeak& peak) { peaks.push_back(peak); });
}

class EdgeGatherer {
 public:
  EdgeGatherer(const VerifyParams& params, const VerifyInput& input) : params_(params), in_(input) {}

  // Gives the length of all samples, also of those outside of the image, px.
  float Run(const EdgeSamples& samples) {
    float total_px = 0;
    std::size_t edge = 0;
    for (const EdgeSample& s : samples) {
      if (s.edge != edge || piece_.count() == params_.piece_samples) ClosePiece(edge);
      edge = s.edge;
      total_px += s.weight_px;
      if (!in_.left_edges.Contains(s.left.x(), s.left.y())) continue;
      sums_[edge].length_px += s.weight_px;
      Test(s, sums_[edge]);
    }
    ClosePiece(edge);
    return total_px;
  }

  [[nodiscard]] std::span<const EdgeSums> sums() const { return sums_; }

 private:
  void ClosePiece(std::size_t edge) {
    sums_[edge].Add(piece_, params_.noise_floor);
    piece_ = {};
  }

  // Do both images show an edge here (the left one alone where the right image does not reach)? And beside it?
  void Test(const EdgeSample& s, EdgeSums& sums) {
    // Windows beside the edge that tell what chance is; the smoothing keeps those within 5 px dependent.
    constexpr std::array<float, 4> kChances = {-10, -6, 6, 10};
    const Vector2 normal(-s.tangent.y(), s.tangent.x());
    if (!left_.Read(in_.left_smooth, in_.camera.width, in_.camera.height, s.left, normal, kEdgeRange)) return;
    const Vector2 right_at(s.left.x() - s.disparity, s.left.y());
    const Vector2 right_normal(-s.tangent_right.y(), s.tangent_right.x());
    const bool right = in_.camera.has_right_image && right_.Read(in_.right_smooth, in_.camera.width, in_.camera.height,
                                                                 right_at, right_normal, kEdgeRange);
    piece_.Add(left_, right ? &right_ : nullptr, s.weight_px);
    CollectPeaks(left_, in_.left_edges.threshold, left_peaks_);
    right_peaks_.clear();
    if (right) CollectPeaks(right_, in_.right_edges.threshold, right_peaks_);
    for (const float chance : kChances) sums.chance_hits += Find(chance, right).found() ? 1.0F : 0.0F;
    sums.chances += static_cast<float>(kChances.size());
    sums.Add(Find(0, right), normal.x(), params_.sharp_offset_px);
  }

  // The nearest support of an edge at offset `at`.
  [[nodiscard]] Support Find(float at, bool right) const {
    Support best;
    for (const EdgePeak& l : left_peaks_) {
      const float left_px = std::abs(l.offset_px - at);
      if (left_px > params_.max_offset_px || left_px >= best.worst_px) continue;
      if (!right) {
        best = {l.offset_px - at, left_px, 0};
        continue;
      }
      for (const EdgePeak& r : right_peaks_) {
        const float worst_px = std::max(left_px, std::abs(r.offset_px - at));
        if (worst_px < std::min(best.worst_px, params_.max_offset_px) && (l.gradient > 0) == (r.gradient > 0) &&
            std::abs(l.offset_px - r.offset_px) < params_.max_difference_px) {
          best = {l.offset_px - at, worst_px, l.offset_px - r.offset_px};
        }
      }
    }
    return best;
  }

  const VerifyParams& params_;
  const VerifyInput& in_;
  EdgeProfile left_, right_;
  Peaks left_peaks_, right_peaks_;
  EdgePiece piece_;
  std::array<EdgeSums, kMaxModelEdges> sums_{};
};

}  // namespace

void GatherEdgeEvidence(const VerifyParams& params, const VerifyInput& input, const PreparedModel& model,
                        const Pose& T_camera_model, const EdgeSamples& samples, EdgeEvidence& out) {
  EdgeGatherer gatherer(params, input);
  const float total_px = gatherer.Run(samples);
  SummarizeEdges(params, model, T_camera_model, gatherer.sums(), total_px, out);
}

}  // namespace wirepose
