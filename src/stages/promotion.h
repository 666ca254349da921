// Stage 5b: corresponding line sets that share a pose are combined and ranked (paper section 3.2, steps 5-7).
#ifndef WIREPOSE_STAGES_PROMOTION_H_
#define WIREPOSE_STAGES_PROMOTION_H_

#include <cstdint>

#include "base/fixed_vector.h"
#include "stages/hypotheses.h"
#include "stages/set_rank.h"

namespace wirepose {

struct PromotionParams {
  float max_offset_px = 8;          // of a segment's ends from the projected edge; halved in the second round
  float min_cosine = 0.97F;         // of the angle between segment and projected edge
  float sigma_px = 0.7F;            // image residuals
  float sigma_disparity_px = 0.5F;  // in addition to the line's own
  float duplicate_share = 0.04F;    // of the diameter: hypotheses whose box corners are nearer than this are one ...
  float aligned_duplicate_share = 0.08F;  // ... and so are aligned sets: refinement would bring them together
  // Strength of a set: its coarse score, and this for each line and for each surface that it covers.
  float line_gain = 2.0F, face_gain = 3.0F;
  float min_score_share = 0.3F;  // of the best hypothesis's score: what is weaker is not promoted
  float min_rank = 0.02F;        // a set that is less probable is not worth an adjustment
};

// One line of a corresponding set.
struct SetMember {
  std::uint16_t line = 0;  // image line
  std::uint16_t edge = 0;  // model edge
};

// A promoted corresponding line set: all image lines that agree with one pose, and that pose.
struct CorrespondingSet {
  Matrix3 R = Matrix3::Identity();  // T_camera_model, aligned to the set
  Vector3 t = Vector3::Zero();
  FixedVector<SetMember, kMaxSetLines> members;  // the longest ones
  std::uint16_t line_count = 0;                  // distinct model edges that found a line
  std::uint16_t face_count = 0;                  // visible surfaces that those edges touch
  float score = 0;                               // coarse score of the aligned pose
  float strength = 0;                            // of sets that are one pose the strongest stays
  SetEvidence evidence;
  float rank = 0;  // the probability, by the evidence, that an object is near
};
using CorrespondingSets = FixedVector<CorrespondingSet, kMaxPromoted>;

// Hypotheses that are one pose (up to the model's symmetries) are merged and each pose is promoted: every image line
// that lies along a visible model edge joins the set, and the pose is aligned to the whole set by weighted least
// squares of the lines' image positions and disparities (eq. 10, in the space where the errors are Gaussian). Of
// aligned poses that meet, the strongest set by score, lines and surfaces stays (the paper's ranking); what remains is
// ranked by all that is known of a set so far, best first. `hypotheses` best first, of which the first kMaxPromoted
// poses that come near the best one are promoted; gives the number of such hypotheses that are of yet other poses, for
// which there was no room. O(hypotheses * promoted + promoted * visible edges * lines).
std::uint32_t PromoteSets(const PromotionParams& params, const PoseScorer& scorer, const RectifiedCamera& camera,
                          const PreparedModel& model, const Lines3& lines, std::span<const Hypothesis> hypotheses,
                          CorrespondingSets& out);

// The sets to adjust: the first kMaxRefined that are probable enough.
std::span<const CorrespondingSet> WorthRefining(const PromotionParams& params, const CorrespondingSets& sets);

// True when the two poses put the model's box corners within `tolerance_m` of each other, modulo its symmetries.
bool IsSamePose(const PreparedModel& model, const Matrix3& R1, const Vector3& t1, const Matrix3& R2, const Vector3& t2,
                float tolerance_m);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_PROMOTION_H_
