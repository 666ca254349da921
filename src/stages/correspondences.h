// Stage 4: corresponding line sets (paper section 3.2, steps 1-4).
#ifndef WIREPOSE_STAGES_CORRESPONDENCES_H_
#define WIREPOSE_STAGES_CORRESPONDENCES_H_

#include <cstdint>

#include "base/keep_best_of_many.h"
#include "model/prepared_model.h"
#include "stages/line_sets.h"
#include "stages/pair_rank.h"

namespace wirepose {

struct CorrespondenceParams {
  float sigmas = 2.5F;             // how many of its own standard deviations an image value may be off
  float length_tolerance = 0.06F;  // stereo and model scale may disagree by this share
  float end_tolerance_m = 0.006F;
  float angle_tolerance_rad = 0.06F;
  float min_cover = 0.3F;        // share of the base edge that its image line must cover
  float min_other_cover = 0.2F;  // the same of the other edge
  PairWeightTable rank = DefaultPairWeights();
  // Members compared with image pairs, for one model in one frame: bounds the time. Simulated kitchens need up to
  // 280,000 with 3,072 image pairs.
  std::uint32_t max_steps = 1'000'000;
};

// The smallest corresponding line set: an image pair and the model pair that shares its parameter vector.
struct CorrespondingPair {
  std::uint16_t image_pair = 0;  // index into ImageLineSets::pairs
  std::uint16_t base_edge = 0;   // model edges
  std::uint16_t other_edge = 0;
  std::uint8_t base_flipped = 0;  // 1: the edge runs against its image line
  std::uint8_t junction = 0;      // 1: the image junction is the model corner that both edges share
  std::uint8_t promotions = 0;    // edges that found a line with this base line on this edge, at most kMaxPromotions
  float rank = 0;                 // log odds of being right
};

struct BetterPair {
  bool operator()(const CorrespondingPair& p, const CorrespondingPair& q) const {
    if (p.rank != q.rank) return p.rank > q.rank;
    if (p.image_pair != q.image_pair) return p.image_pair < q.image_pair;
    if (p.base_edge != q.base_edge) return p.base_edge < q.base_edge;
    if (p.other_edge != q.other_edge) return p.other_edge < q.other_edge;
    return p.base_flipped < q.base_flipped;
  }
};
using CorrespondingPairs = KeepBestOfMany<CorrespondingPair, kMaxCorrespondences, BetterPair>;

// Every image pair whose parameter vector agrees with that of a model pair. Lengths are unreliable: a segment may be
// any part of its edge that is not too short, but it cannot be longer. Symmetric models are searched from one edge of
// each symmetry orbit. Pairs are ranked by how V agrees under its own sigma, by length and cover of the lines, and by
// how many other lines fit the same assignment of the base (pair_rank.h); members too far off to be kept are neither
// made nor counted. O(pairs * representative base edges * members), at most `max_steps`: base lines come by falling
// length, and those for which no steps are left are not searched. Returns false when that happened.
bool FindCorrespondences(const CorrespondenceParams& params, const RectifiedCamera& camera, const PreparedModel& model,
                         const Lines3& lines, const ImageLineSets& sets, CorrespondingPairs& out);

// The terms of a pair that FindCorrespondences made of the same arguments, for fitting and tests. O(members).
PairTerms TermsOf(const PreparedModel& model, const Lines3& lines, const ImageLineSets& sets,
                  const CorrespondingPair& match);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_CORRESPONDENCES_H_
