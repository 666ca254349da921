#include "stages/pair_rank.h"

#include <algorithm>

#include "base/portable_math.h"

namespace wirepose {

const std::array<const char*, kPairTerms>& PairTermNames() {
  static constexpr std::array<const char*, kPairTerms> kNames = {
      "base_px",   "other_px",      "angle_sigma",        "distance_sigma",   "depth",       "meet",
      "base_edge", "base_cover",    "base_cover_squared", "other_edge",       "other_cover", "other_cover_squared",
      "reach",     "reach_squared", "angle_squared",      "distance_squared", "promotion"};
  return kNames;
}

PairRanker::PairRanker(const PairWeightTable& weights, const PreparedModel& model, const Lines3& lines)
    : weights_(weights) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    log_px_[i] = Log(lines[i].segment.Length());
    if (lines[i].has_depth) log_depth_[i] = Log(0.5F * (lines[i].a.z() + lines[i].b.z()));
  }
  float longest_m = 1e-3F;
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    log_share_[e] = Log(model.edges[e].length_m / model.view.diameter_m);
    longest_m = std::max(longest_m, model.edges[e].length_m);
  }
  for (const PreparedMember& m : model.members) shortest_reach_m_ = std::min(shortest_reach_m_, m.farthest_end_m);
  lengths_per_m_ = static_cast<float>(kLengths) / longest_m;
  for (std::size_t c = 0; c < kPairClasses; ++c) {
    const auto pair_class = static_cast<PairClass>(c);
    most_of_promotions_[c] = std::max(0.0F, OfPromotions(pair_class, kMaxPromotions));
    for (std::size_t i = 0; i <= kLengths; ++i) {
      const float low_m = static_cast<float>(i) / lengths_per_m_;
      most_of_other_[c][i] = MostOfOther(pair_class, model, low_m, i < kLengths ? low_m + 1 / lengths_per_m_ : 1e9F);
    }
  }
}

float PairRanker::OfPair(PairClass c, const ImageLinePair& pair) const {
  const PairWeights& w = Of(c);
  float rank = w.bias + w[PairTerm::kBasePx] * log_px_[pair.base] + w[PairTerm::kOtherPx] * log_px_[pair.other] +
               w[PairTerm::kDepth] * log_depth_[pair.base];
  if (pair.base_end != LineEnd::kNone) rank += w[PairTerm::kMeet];
  if (!pair.metric) return rank;
  return rank + w[PairTerm::kAngleSigma] * pair.log_angle_sigma + w[PairTerm::kDistanceSigma] * pair.log_distance_sigma;
}

float PairRanker::OfBase(PairClass c, std::size_t edge, float cover) const {
  const PairWeights& w = Of(c);
  return w[PairTerm::kBaseEdge] * log_share_[edge] +
         cover * (w[PairTerm::kBaseCover] + cover * w[PairTerm::kBaseCoverSquared]);
}

float PairRanker::OfOther(PairClass c, const ImageLinePair& pair, const PreparedMember& member,
                          float other_cover) const {
  const PairWeights& w = Of(c);
  const float rank = w[PairTerm::kOtherEdge] * log_share_[member.other_edge];
  if (!pair.metric) return rank;
  const float reach = std::min(1.0F, pair.farthest_end_m / member.farthest_end_m);
  const float angle = (pair.angle_rad - member.angle_rad) / AngleSigma(pair);
  const float distance = (pair.distance_m - member.distance_m) / DistanceSigma(pair, member.distance_m);
  return rank + other_cover * (w[PairTerm::kOtherCover] + other_cover * w[PairTerm::kOtherCoverSquared]) +
         reach * (w[PairTerm::kReach] + reach * w[PairTerm::kReachSquared]) +
         w[PairTerm::kAngleSquared] * (angle * angle) + w[PairTerm::kDistanceSquared] * (distance * distance);
}

float PairRanker::OfPromotions(PairClass c, int count) const {
  return Of(c)[PairTerm::kPromotion] * static_cast<float>(count);
}

namespace {

// The most that linear and square weight give for a share from `low` to `high`.
float MostOfShare(float linear, float square, float low, float high) {
  const auto at = [&](float share) { return share * (linear + share * square); };
  const float most = std::max(at(low), at(high));
  return square < 0 ? std::max(most, at(std::clamp(-0.5F * linear / square, low, high))) : most;
}

}  // namespace

float PairRanker::MostOfOther(PairClass c, const PreparedModel& model, float low_m, float high_m) const {
  const PairWeights& w = Of(c);
  float most = -1e9F;
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    float here = w[PairTerm::kOtherEdge] * log_share_[e];
    if (c != PairClass::kFlat) {
      const float length_m = model.edges[e].length_m;
      here += MostOfShare(w[PairTerm::kOtherCover], w[PairTerm::kOtherCoverSquared], std::min(1.0F, low_m / length_m),
                          std::min(1.0F, high_m / length_m));
    }
    most = std::max(most, here);
  }
  return most;
}

float PairRanker::Most(PairClass c, const ImageLinePair& pair, float other_m) const {
  constexpr float kRounding = 2e-3F;  // far more than what the sum may be too low by
  const PairWeights& w = Of(c);
  const auto length = std::min(kLengths, static_cast<std::size_t>(other_m * lengths_per_m_));
  const float most = most_of_other_[static_cast<std::size_t>(c)][length] +
                     most_of_promotions_[static_cast<std::size_t>(c)] + kRounding;
  if (!pair.metric) return most;
  return most + MostOfShare(w[PairTerm::kReach], w[PairTerm::kReachSquared], 0,
                            std::min(1.0F, pair.farthest_end_m / shortest_reach_m_));
}

}  // namespace wirepose
