#include "stages/edge_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "stages/edge_profile.h"

namespace wirepose {
namespace {

constexpr int kRange = 12;  // px of profile to each side of an edge

// Gradient profiles of neighbouring samples of one edge, added up in both images: along a true edge the noise averages
// out, and an edge too faint for any single sample stands out.
class EdgePiece {
 public:
  void Add(const EdgeProfile& left, const EdgeProfile* right, float length_px) {
    for (int o = -kRange; o <= kRange; ++o) left_[Index(o)] += left.GradientAt(o);
    ++left_count_;
    length_px_ += length_px;
    if (right == nullptr) return;
    for (int o = -kRange; o <= kRange; ++o) right_[Index(o)] += right->GradientAt(o);
    ++right_count_;
  }

  [[nodiscard]] int count() const { return left_count_; }
  [[nodiscard]] float length_px() const { return length_px_; }

  // How much what both images show at the edge stands out from what they show 4 to 12 px beside it, 0..1.
  [[nodiscard]] float Distinctness(float noise_floor) const {
    float centre = 0, beside = 0;
    int beside_count = 0;
    for (int o = -kRange; o <= kRange; ++o) {
      if (std::abs(o) == 3) continue;
      const float strength = Common(o);
      if (std::abs(o) < 3) {
        centre = std::max(centre, strength);
      } else {
        beside += strength;
        ++beside_count;
      }
    }
    const float background = 2 * beside / static_cast<float>(beside_count) + noise_floor * kGradientOne;
    return centre / (centre + background);
  }

 private:
  static std::size_t Index(int offset) { return static_cast<std::size_t>(offset + kRange); }

  // The weaker of the two images' gradients of equal polarity, the right one within a pixel.
  [[nodiscard]] float Common(int o) const {
    const float left = left_[Index(o)] / static_cast<float>(left_count_);
    if (right_count_ == 0) return std::abs(left);
    float right = 0;
    for (int r = std::max(-kRange, o - 1); r <= std::min(kRange, o + 1); ++r) {
      right = std::max(right, left > 0 ? right_[Index(r)] : -right_[Index(r)]);
    }
    return std::min(std::abs(left), right / static_cast<float>(right_count_));
  }

  std::array<float, 2 * kRange + 1> left_{}, right_{};
  int left_count_ = 0, right_count_ = 0;
  float length_px_ = 0;
};

// A supporting image edge at a sample: how far from the model edge, in the left image and in the worse of both.
struct Support {
  float left_px = 0, worst_px = 1e9F;
  [[nodiscard]] bool found() const { return worst_px < 1e9F; }
};

// Sums over the samples of one model edge.
struct EdgeSums {
  float length_px = 0, samples = 0, hits = 0, sharp = 0, chances = 0, chance_hits = 0;
  float offset = 0, offset_squared = 0;         // of the hits in the left image, px
  float piece_px = 0, distinct = 0, clear = 0;  // of averaged pieces, weighted by their length

  void Add(const Support& support, float sharp_offset_px) {
    samples += 1;
    if (!support.found()) return;
    hits += 1;
    sharp += support.worst_px < sharp_offset_px ? 1.0F : 0.0F;
    offset += support.left_px;
    offset_squared += support.left_px * support.left_px;
  }
  void Add(const EdgePiece& piece, float noise_floor) {
    if (piece.count() == 0) return;
    const float distinctness = piece.Distinctness(noise_floor);
    piece_px += piece.length_px();
    distinct += piece.length_px() * distinctness;
    clear += distinctness > 0.5F ? piece.length_px() : 0.0F;
  }
  void Add(const EdgeSums& other) {
    samples += other.samples, hits += other.hits, sharp += other.sharp;
    chances += other.chances, chance_hits += other.chance_hits;
    length_px += other.length_px, piece_px += other.piece_px, distinct += other.distinct, clear += other.clear;
  }
};

float Share(float part, float whole) { return whole > 0 ? part / whole : 0; }

using Peaks = FixedVector<EdgePeak, 2 * EdgeProfile::kMaxRange>;

void CollectPeaks(const EdgeProfile& profile, float threshold, Peaks& peaks) {
  peaks.clear();
  profile.ForEachPeak(threshold, [&](const EdgePeak& peak) { peaks.push_back(peak); });
}

class Gatherer {
 public:
  Gatherer(const VerifyParams& params, const VerifyInput& input) : params_(params), in_(input) {}

  void Run(const EdgeSamples& samples, EdgeEvidence& out) {
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
    Summarize(total_px, out);
  }

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
    if (!left_.Read(in_.left_smooth, in_.camera.width, in_.camera.height, s.left, normal, kRange)) return;
    const Vector2 right_at(s.left.x() - s.disparity, s.left.y());
    const Vector2 right_normal(-s.tangent_right.y(), s.tangent_right.x());
    const bool right = in_.camera.has_right_image && right_.Read(in_.right_smooth, in_.camera.width, in_.camera.height,
                                                                 right_at, right_normal, kRange);
    piece_.Add(left_, right ? &right_ : nullptr, s.weight_px);
    CollectPeaks(left_, in_.left_edges.threshold, left_peaks_);
    right_peaks_.clear();
    if (right) CollectPeaks(right_, in_.right_edges.threshold, right_peaks_);
    for (const float chance : kChances) sums.chance_hits += Find(chance, right).found() ? 1.0F : 0.0F;
    sums.chances += static_cast<float>(kChances.size());
    sums.Add(Find(0, right), params_.sharp_offset_px);
  }

  // The nearest support of an edge at offset `at`.
  [[nodiscard]] Support Find(float at, bool right) const {
    Support best;
    for (const EdgePeak& l : left_peaks_) {
      const float left_px = std::abs(l.offset_px - at);
      if (left_px > params_.max_offset_px || left_px >= best.worst_px) continue;
      if (!right) {
        best = {l.offset_px - at, left_px};
        continue;
      }
      for (const EdgePeak& r : right_peaks_) {
        const float worst_px = std::max(left_px, std::abs(r.offset_px - at));
        if (worst_px < std::min(best.worst_px, params_.max_offset_px) && (l.gradient > 0) == (r.gradient > 0) &&
            std::abs(l.offset_px - r.offset_px) < params_.max_difference_px) {
          best = {l.offset_px - at, worst_px};
        }
      }
    }
    return best;
  }

  void Summarize(float total_px, EdgeEvidence& out) const {
    out = {.weakest_edge = 1, .dimmest_edge = 1};
    EdgeSums all;
    float variance = 0, spread_hits = 0;
    for (const EdgeSums& e : sums_) {
      all.Add(e);
      if (e.hits > 3) {
        variance += e.offset_squared - e.offset * e.offset / e.hits;
        spread_hits += e.hits;
      }
      if (e.length_px < params_.min_edge_px || e.samples < 3) continue;
      out.edges += 1;
      out.full_edges += Share(e.hits, e.samples) > 0.8F ? 1.0F : 0.0F;
      out.weakest_edge = std::min(out.weakest_edge, Share(e.hits, e.samples));
      out.dimmest_edge = std::min(out.dimmest_edge, Share(e.distinct, e.piece_px));
    }
    out.full_edges = Share(out.full_edges, out.edges);
    out.visible_px = all.length_px;
    out.inside = Share(all.length_px, total_px);
    out.support = Share(all.hits, all.samples);
    out.chance = Share(all.chance_hits, all.chances);
    out.sharp = Share(all.sharp, all.samples);
    out.sharp_of_support = Share(all.sharp, all.hits);
    out.spread_px = spread_hits > 0 ? std::sqrt(std::max(0.0F, variance / spread_hits)) : params_.max_offset_px;
    out.distinct = Share(all.distinct, all.piece_px);
    out.clear = Share(all.clear, all.piece_px);
  }

  const VerifyParams& params_;
  const VerifyInput& in_;
  EdgeProfile left_, right_;
  Peaks left_peaks_, right_peaks_;
  EdgePiece piece_;
  std::array<EdgeSums, kMaxModelEdges> sums_{};
};

}  // namespace

void GatherEdgeEvidence(const VerifyParams& params, const VerifyInput& input, const EdgeSamples& samples,
                        EdgeEvidence& out) {
  Gatherer(params, input).Run(samples, out);
}

}  // namespace wirepose
