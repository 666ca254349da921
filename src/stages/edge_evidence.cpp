#include "stages/edge_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/portable_math.h"
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

// Support of one model edge: samples in both images, hits at the edge itself and beside it.
struct EdgeSupport {
  float length_px = 0, samples = 0, hits = 0, chances = 0, chance_hits = 0, supported_px = 0;
};

using Peaks = FixedVector<EdgePeak, 2 * EdgeProfile::kMaxRange>;

void CollectPeaks(const EdgeProfile& profile, float threshold, Peaks& peaks) {
  peaks.clear();
  profile.ForEachPeak(threshold, [&](const EdgePeak& peak) { peaks.push_back(peak); });
}

class Gatherer {
 public:
  Gatherer(const VerifyParams& params, const VerifyInput& input, const PreparedModel& model, const Vector3& eye,
           Evidence& out)
      : params_(params), in_(input), model_(model), eye_(eye), out_(out) {}

  void Run(const EdgeSamples& samples) {
    std::array<EdgeSupport, kMaxModelEdges> support{};
    float inside = 0, total = 0, supported = 0;
    for (const EdgeSample& s : samples) {
      if (s.edge != edge_ || piece_.count() == params_.piece_samples) ClosePiece();
      edge_ = s.edge;
      total += s.weight_px;
      if (!in_.left_edges.Contains(s.left.x(), s.left.y())) continue;
      inside += s.weight_px;
      support[s.edge].length_px += s.weight_px;
      if (!Test(s, support[s.edge])) continue;
      supported += s.weight_px;
      support[s.edge].supported_px += s.weight_px;
    }
    ClosePiece();
    Sum(support);
    out_.distinct = piece_px_ > 0 ? distinct_px_ / piece_px_ : 0;
    out_.support = inside > 0 ? supported / inside : 0;
    out_.inside = total > 0 ? inside / total : 0;
    out_.visible_px = inside;
    CountSupported(support);
  }

 private:
  void ClosePiece() {
    if (piece_.count() > 0) {
      distinct_px_ += piece_.length_px() * piece_.Distinctness(params_.noise_floor);
      piece_px_ += piece_.length_px();
    }
    piece_ = {};
  }

  // True when both images show an edge here (the left one alone where the right image does not reach).
  bool Test(const EdgeSample& s, EdgeSupport& support) {
    // Windows beside the edge that tell what chance is; the smoothing keeps those within 5 px dependent.
    constexpr std::array<float, 4> kChances = {-10, -6, 6, 10};
    const Vector2 normal(-s.tangent.y(), s.tangent.x());
    if (!left_.Read(in_.left_smooth, in_.camera.width, in_.camera.height, s.left, normal, kRange)) return false;
    const Vector2 right_at(s.left.x() - s.disparity, s.left.y());
    const Vector2 right_normal(-s.tangent_right.y(), s.tangent_right.x());
    const bool right =
        right_.Read(in_.right_smooth, in_.camera.width, in_.camera.height, right_at, right_normal, kRange);
    piece_.Add(left_, right ? &right_ : nullptr, s.weight_px);
    CollectPeaks(left_, in_.left_edges.threshold, left_peaks_);
    right_peaks_.clear();
    if (right) CollectPeaks(right_, in_.right_edges.threshold, right_peaks_);
    for (const float chance : kChances) support.chance_hits += Hits(chance, right) ? 1.0F : 0.0F;
    support.chances += static_cast<float>(kChances.size());
    support.samples += 1;
    const bool hit = Hits(0, right);
    if (hit) support.hits += 1;
    return hit;
  }

  [[nodiscard]] bool Hits(float at, bool right) const {
    for (const EdgePeak& l : left_peaks_) {
      if (std::abs(l.offset_px - at) > params_.max_offset_px) continue;
      if (!right) return true;
      for (const EdgePeak& r : right_peaks_) {
        if (std::abs(r.offset_px - at) < params_.max_offset_px && (l.gradient > 0) == (r.gradient > 0) &&
            std::abs(l.offset_px - r.offset_px) < params_.max_difference_px) {
          return true;
        }
      }
    }
    return false;
  }

  void Sum(const std::array<EdgeSupport, kMaxModelEdges>& support) {
    EdgeSupport all;
    for (const EdgeSupport& e : support) {
      out_.edges += LogRatio(e);
      all.samples += e.samples;
      all.hits += e.hits;
      all.chances += e.chances;
      all.chance_hits += e.chance_hits;
    }
    if (all.samples > 0) out_.contrast = all.hits / all.samples - all.chance_hits / all.chances;
  }

  [[nodiscard]] float LogRatio(const EdgeSupport& e) const {
    if (e.samples < 1) return 0;
    // An edge of one direction within 2 px is what the edge map counts; equal polarity and offset in both images are
    // rarer.
    const float chance = std::clamp(0.7F * in_.left_edges.background, 0.03F, 0.4F);
    const float weight = e.length_px / (e.samples * params_.independent_px);
    return weight * (e.hits * Log(params_.support_rate / chance) +
                     (e.samples - e.hits) * Log((1 - params_.support_rate) / (1 - chance)));
  }

  void CountSupported(const std::array<EdgeSupport, kMaxModelEdges>& support) {
    std::array<std::uint32_t, kMaxModelFaces / 32> faces{};
    for (std::size_t e = 0; e < model_.edges.size(); ++e) {
      if (support[e].length_px <= 0 || support[e].supported_px < 0.5F * support[e].length_px) continue;
      ++out_.supported_edges;
      for (const std::uint16_t face : model_.view.edges[e].face) {
        if (face == kNoFace || !IsTowards(model_.view.faces[face], eye_)) continue;
        std::uint32_t& word = faces[face / 32];
        const std::uint32_t bit = 1U << (face % 32);
        if ((word & bit) == 0) ++out_.supported_faces;
        word |= bit;
      }
    }
  }

  const VerifyParams& params_;
  const VerifyInput& in_;
  const PreparedModel& model_;
  Vector3 eye_;
  Evidence& out_;
  EdgeProfile left_, right_;
  Peaks left_peaks_, right_peaks_;
  EdgePiece piece_;
  std::uint16_t edge_ = 0;
  float distinct_px_ = 0, piece_px_ = 0;
};

}  // namespace

void GatherEdgeEvidence(const VerifyParams& params, const VerifyInput& input, const PreparedModel& model,
                        const Vector3& eye, const EdgeSamples& samples, Evidence& out) {
  Gatherer(params, input, model, eye, out).Run(samples);
}

}  // namespace wirepose
