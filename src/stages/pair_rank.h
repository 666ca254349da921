// Stage 4b: how likely a corresponding pair is to be right: which of very many are followed up.
#ifndef WIREPOSE_STAGES_PAIR_RANK_H_
#define WIREPOSE_STAGES_PAIR_RANK_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/fixed_vector.h"
#include "model/prepared_model.h"
#include "stages/line_sets.h"

namespace wirepose {

// What the two image lines are to each other decides what their numbers are worth.
enum class PairClass : std::uint8_t {
  kFlat,      // one is known in the image only: they meet there
  kParallel,  // both have depth, as all that follow
  kCorner,    // they meet at the corner that their edges share
  kApart,
};
inline constexpr std::size_t kPairClasses = 4;

// Terms of the rank. Logarithms are natural; covers and reach are at most 1. Without depth: 0 from kOtherCover on but
// for the last.
enum class PairTerm : std::uint8_t {
  // Of the image pair.
  kBasePx,         // log of the base line's length in the image
  kOtherPx,        // and of the other one's
  kAngleSigma,     // log(rad + 0.02)
  kDistanceSigma,  // log of cm + 0.3
  kDepth,          // log of the base line's depth, m
  kMeet,           // 1: they meet in the image
  // Of the base line on its edge, and of the other edge.
  kBaseEdge,  // log of its length over the model's diameter
  kBaseCover,
  kBaseCoverSquared,
  kOtherEdge,
  // Of the pair's parameter vector V beside the model's.
  kOtherCover,
  kOtherCoverSquared,
  kReach,  // the pair's farthest ends over the model's
  kReachSquared,
  kAngleSquared,     // difference over its standard deviation
  kDistanceSquared,  // the same
  // Of all pairs with this base line on this edge.
  kPromotion,  // other edges that found a line, at most kMaxPromotions
};
inline constexpr std::size_t kPairTerms = 17;
using PairTerms = std::array<float, kPairTerms>;
inline constexpr int kMaxPromotions = 8;

const std::array<const char*, kPairTerms>& PairTermNames();

// One class's log odds of being right: bias and a weight a term. Those of squared differences are below 0.
struct PairWeights {
  float bias = 0;
  PairTerms of{};

  [[nodiscard]] float operator[](PairTerm term) const { return of[static_cast<std::size_t>(term)]; }
};

using PairWeightTable = std::array<PairWeights, kPairClasses>;

// Logistic regression by tools/evaluation/fit_pairs.py over the pairs of simulated scenes, one table for all models.
const PairWeightTable& DefaultPairWeights();

// The class of a pair; `corner`: it meets at the corner that both model edges share.
inline PairClass ClassOf(const ImageLinePair& pair, bool corner) {
  if (!pair.metric) return PairClass::kFlat;
  if (pair.kind == LineSetKind::kParallel) return PairClass::kParallel;
  return corner ? PairClass::kCorner : PairClass::kApart;
}

// Standard deviations that a pair's angle and distance are compared by: the lines' own and the model's.
inline float AngleSigma(const ImageLinePair& pair) { return 0.02F + pair.angle_sigma_rad; }
inline float DistanceSigma(const ImageLinePair& pair, float model_distance_m) {
  return 0.003F + 0.01F * model_distance_m + pair.distance_sigma_m;
}

// The rank of pairs of one model in one frame, in parts that are known one after the other: it is their sum.
class PairRanker {
 public:
  PairRanker(const PairWeightTable& weights, const PreparedModel& model, const Lines3& lines);

  [[nodiscard]] float OfPair(PairClass c, const ImageLinePair& pair) const;
  // Base line on its edge: `cover` is the share of the edge that the line shows.
  [[nodiscard]] float OfBase(PairClass c, std::size_t edge, float cover) const;
  // A pair without depth says no more than where its lines meet: `other_cover` and V are left out.
  [[nodiscard]] float OfOther(PairClass c, const ImageLinePair& pair, const PreparedMember& member,
                              float other_cover) const;
  [[nodiscard]] float OfPromotions(PairClass c, int count) const;

  // No member of the model and no promotion add more to the rank of a pair whose other line is `other_m` long (0
  // without depth).
  [[nodiscard]] float Most(PairClass c, const ImageLinePair& pair, float other_m) const;
  // The loss by a difference of one standard deviation, above 0.
  [[nodiscard]] float LossOfAngle(PairClass c) const { return -Of(c)[PairTerm::kAngleSquared]; }
  [[nodiscard]] float LossOfDistance(PairClass c) const { return -Of(c)[PairTerm::kDistanceSquared]; }

 private:
  [[nodiscard]] const PairWeights& Of(PairClass c) const { return weights_[static_cast<std::size_t>(c)]; }
  // For lengths of an other line from low_m to high_m.
  [[nodiscard]] float MostOfOther(PairClass c, const PreparedModel& model, float low_m, float high_m) const;

  static constexpr std::size_t kLengths = 32;  // up to the longest edge

  const PairWeightTable& weights_;
  std::array<float, kMaxSegments> log_px_{}, log_depth_{};
  std::array<float, kMaxModelEdges> log_share_{};  // of the model's diameter
  float lengths_per_m_ = 0, shortest_reach_m_ = 1e9F;
  std::array<std::array<float, kLengths + 1>, kPairClasses> most_of_other_{};  // by length
  std::array<float, kPairClasses> most_of_promotions_{};
};

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_PAIR_RANK_H_
