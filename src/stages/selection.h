// Stage 8: which candidates are reported.
#ifndef WIREPOSE_STAGES_SELECTION_H_
#define WIREPOSE_STAGES_SELECTION_H_

#include "base/keep_best.h"
#include "stages/promotion.h"
#include "stages/refinement.h"
#include "stages/verification.h"

namespace wirepose {

// Score = logistic function of the evidence. One set of weights for all models and data, fitted to simulated kitchens
// by tools/evaluation/fit_score.py, never to recorded test data; log_length is given, not fitted: evidence of equal
// density counts more the longer it is (as in a-contrario detection), which scenes with few sizes of objects cannot
// teach.
struct ScoreParams {
  float bias = -10.14F;
  float edge_density = 0.33F;  // per log-likelihood unit and 100 px of visible edge
  float log_length = 1.0F;     // per natural logarithm of visible edge length over 300 px
  float contrast = 1.22F;      // per unit of contrast with the surroundings
  float distinct = 1.72F;      // per unit of distinctness of the averaged edges
  float overrun = -3.55F;      // per unit of overrun share
  float inside = 2.10F;        // per share of the visible edges that lies in the image
  float faces = 0.08F;         // per unit of face evidence
  float on = 1.80F;            // per share of the surface that the scene's surface is
  float through = -1.74F;      // per share of it that one sees through
  float drop = 2.05F;          // per share of the outline behind which the scene falls back
};

struct SelectParams {
  ScoreParams score;
  float min_score = 0.5F;    // lower ones are not reported
  float max_claimed = 0.5F;  // share of a candidate's supported edges that stronger detections may own
};

// A verified pose of one model in the rectified left frame.
struct Candidate {
  std::uint16_t model = 0;  // index of the added model
  std::uint16_t order = 0;  // among the model's candidates; breaks ties
  RefinedPose pose;
  Evidence evidence;
  FixedVector<SetMember, kMaxSetLines> members;  // the corresponding line set behind it
  float score = 0;
};

struct BetterCandidate {
  bool operator()(const Candidate& p, const Candidate& q) const {
    if (p.score != q.score) return p.score > q.score;
    return p.model != q.model ? p.model < q.model : p.order < q.order;
  }
};
using Candidates = KeepBest<Candidate, kMaxVerified, BetterCandidate>;

// Probability that the candidate is right.
float ScoreOf(const ScoreParams& params, const Evidence& evidence);

// Work space: which 4 x 4 px blocks of the left image belong to an accepted detection's edges.
struct ClaimMap {
  static constexpr int kBlock = 4;
  static constexpr int kWidth = kMaxImageWidth / kBlock;
  static constexpr int kHeight = kMaxImageHeight / kBlock;
  std::array<bool, std::size_t{kWidth} * kHeight> claimed;
};

// Greedy and exclusive: candidates by falling score; each owns the image edges that support it, and one whose support
// mostly belongs to others is dropped. Instances of one model at the same place (modulo symmetry) merge. `accepted`
// receives indices into `candidates`, best first. O(candidates * samples).
void SelectDetections(const SelectParams& params, const RectifiedCamera& camera, const EdgeMap& left,
                      std::span<const PreparedModel> models, std::span<const Candidate> candidates,
                      VerifyScratch& scratch, ClaimMap& claims, FixedVector<std::uint16_t, kMaxDetections>& accepted,
                      std::uint32_t& dropped);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_SELECTION_H_
