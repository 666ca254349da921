// What is summed up over the samples of one model edge before it speaks for or against a pose.
#ifndef WIREPOSE_STAGES_EDGE_SUMS_H_
#define WIREPOSE_STAGES_EDGE_SUMS_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "stages/edge_profile.h"

namespace wirepose {

inline constexpr int kEdgeRange = 12;  // px of profile to each side of an edge

// Gradient profiles of neighbouring samples of one edge, added up in both images: along a true edge the noise averages
// out, and an edge too faint for any single sample stands out.
class EdgePiece {
 public:
  void Add(const EdgeProfile& left, const EdgeProfile* right, float length_px) {
    for (int o = -kEdgeRange; o <= kEdgeRange; ++o) left_[Index(o)] += left.GradientAt(o);
    ++left_count_;
    length_px_ += length_px;
    if (right == nullptr) return;
    for (int o = -kEdgeRange; o <= kEdgeRange; ++o) right_[Index(o)] += right->GradientAt(o);
    ++right_count_;
  }

  [[nodiscard]] int count() const { return left_count_; }
  [[nodiscard]] float length_px() const { return length_px_; }

  // How much what both images show at the edge stands out from what they show 4 to 12 px beside it, 0..1.
  [[nodiscard]] float Distinctness(float noise_floor) const {
    float centre = 0, beside = 0;
    int beside_count = 0;
    for (int o = -kEdgeRange; o <= kEdgeRange; ++o) {
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
  static std::size_t Index(int offset) { return static_cast<std::size_t>(offset + kEdgeRange); }

  // The weaker of the two images' gradients of equal polarity, the right one within a pixel.
  [[nodiscard]] float Common(int o) const {
    const float left = left_[Index(o)] / static_cast<float>(left_count_);
    if (right_count_ == 0) return std::abs(left);
    float right = 0;
    for (int r = std::max(-kEdgeRange, o - 1); r <= std::min(kEdgeRange, o + 1); ++r) {
      right = std::max(right, left > 0 ? right_[Index(r)] : -right_[Index(r)]);
    }
    return std::min(std::abs(left), right / static_cast<float>(right_count_));
  }

  std::array<float, 2 * kEdgeRange + 1> left_{}, right_{};
  int left_count_ = 0, right_count_ = 0;
  float length_px_ = 0;
};

// A supporting image edge at a sample: how far from the model edge, in the left image and in the worse of both.
struct Support {
  float left_px = 0, worst_px = 1e9F;
  float parallax_px = 0;  // difference of the two images' offsets
  [[nodiscard]] bool found() const { return worst_px < 1e9F; }
};

// The hits of the samples next to an end of an edge. Where most of them lack support the edge has no corner there.
struct EndSums {
  static constexpr int kSamples = 3;
  int samples = 0, hits = 0;
  [[nodiscard]] bool full() const { return samples == kSamples; }
  [[nodiscard]] bool held() const { return 2 * hits > samples; }
};

// Sums over the samples of one model edge.
struct EdgeSums {
  float length_px = 0, samples = 0, hits = 0, sharp = 0, chances = 0, chance_hits = 0;
  float offset = 0, offset_squared = 0;  // of the hits in the left image, px
  // Of the hits: products of the difference of both images' offsets and the part of a disparity that it would show.
  float parallax_squared = 0, parallax_across = 0, across_squared = 0;
  float piece_px = 0, distinct = 0, clear = 0;  // of averaged pieces, weighted by their length
  EndSums first;                                // the samples next to the edge's first end
  std::uint32_t recent = 0;                     // bit k: the sample k before the newest was a hit

  // `across`: x of the edge's unit normal, how much of a disparity its offsets show.
  void Add(const Support& support, float across, float sharp_offset_px) {
    samples += 1;
    recent = 2 * recent + (support.found() ? 1U : 0U);
    if (!first.full()) {
      ++first.samples;
      first.hits += support.found() ? 1 : 0;
    }
    if (!support.found()) return;
    hits += 1;
    parallax_squared += support.parallax_px * support.parallax_px;
    parallax_across += support.parallax_px * across;
    across_squared += across * across;
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
  [[nodiscard]] EndSums last() const {
    constexpr std::uint32_t kMask = (1U << EndSums::kSamples) - 1;
    return {std::min(EndSums::kSamples, static_cast<int>(samples)), std::popcount(recent & kMask)};
  }
  void Add(const EdgeSums& other) {
    samples += other.samples, hits += other.hits, sharp += other.sharp;
    parallax_squared += other.parallax_squared;
    parallax_across += other.parallax_across, across_squared += other.across_squared;
    chances += other.chances, chance_hits += other.chance_hits;
    length_px += other.length_px, piece_px += other.piece_px, distinct += other.distinct, clear += other.clear;
  }
};

inline float Share(float part, float whole) { return whole > 0 ? part / whole : 0; }

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_EDGE_SUMS_H_
