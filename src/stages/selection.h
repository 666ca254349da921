// Stage 8: which candidates are reported.
#ifndef WIREPOSE_STAGES_SELECTION_H_
#define WIREPOSE_STAGES_SELECTION_H_

#include "base/keep_best.h"
#include "stages/promotion.h"
#include "stages/refinement.h"
#include "stages/verification.h"

namespace wirepose {

struct SelectParams {
  float min_score = 0.65F;    // lower ones are not reported: just below, alarms in empty scenes counted, half are wrong
  float max_claimed = 0.35F;  // share of a candidate's supported edges that stronger detections may own
};

// A verified pose of one model in the rectified left frame.
struct Candidate {
  std::uint16_t model = 0;  // index of the added model
  std::uint16_t order = 0;  // among the model's candidates; breaks ties
  RefinedPose pose;
  Evidence evidence;
  FixedVector<SetMember, kMaxSetLines> members;  // the corresponding line set behind it
  float score = 0;                               // probability that the pose is right
};

struct BetterCandidate {
  bool operator()(const Candidate& p, const Candidate& q) const {
    if (p.score != q.score) return p.score > q.score;
    return p.model != q.model ? p.model < q.model : p.order < q.order;
  }
};
using Candidates = KeepBest<Candidate, kMaxVerified, BetterCandidate>;

// Work space: which 4 x 4 px blocks of the left image belong to an accepted detection's edges.
struct ClaimMap {
  static constexpr int kBlock = 4;
  static constexpr int kWidth = kMaxImageWidth / kBlock;
  static constexpr int kHeight = kMaxImageHeight / kBlock;
  std::array<bool, std::size_t{kWidth} * kHeight> claimed;
};

// Marks the blocks of the left image's edges that support the model at the pose. O(samples).
void ClaimEdges(const RectifiedCamera& camera, const EdgeMap& left, const PreparedModel& model, const Pose& pose,
                VerifyScratch& scratch, ClaimMap& claims);
// Share of the supporting edges' length that lies in marked blocks, 0..1; 0 when nothing supports the pose. O(samples).
[[nodiscard]] float ClaimedShare(const RectifiedCamera& camera, const EdgeMap& left, const PreparedModel& model,
                                 const Pose& pose, VerifyScratch& scratch, const ClaimMap& claims);

// Greedy and exclusive: candidates by falling score; each owns the image edges that support it, and one of whose
// support more than max_claimed belongs to others is dropped. Instances of one model at the same place (modulo
// symmetry) merge. `accepted` receives indices into `candidates`, best first. O(candidates * samples).
void SelectDetections(const SelectParams& params, const RectifiedCamera& camera, const EdgeMap& left,
                      std::span<const PreparedModel> models, std::span<const Candidate> candidates,
                      VerifyScratch& scratch, ClaimMap& claims, FixedVector<std::uint16_t, kMaxDetections>& accepted,
                      std::uint32_t& dropped);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_SELECTION_H_
