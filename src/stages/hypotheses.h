// Stage 5: pose hypotheses (paper section 3.2, step 7, and eq. 8-10), with hidden lines left out.
#ifndef WIREPOSE_STAGES_HYPOTHESES_H_
#define WIREPOSE_STAGES_HYPOTHESES_H_

#include "base/keep_best.h"
#include "model/prepared_model.h"
#include "stages/correspondences.h"
#include "stages/pose_score.h"

namespace wirepose {

struct HypothesisParams {
  float end_tolerance_px = 5;             // a segment may overrun its projected edge by this much ...
  float end_tolerance_share = 0.08F;      // ... or by this share of it
  float direction_tolerance_rad = 0.15F;  // between the solved and the measured direction of the other line
  float length_angle_tolerance = 0.2F;    // cosine error up to which a direction solved from a length is believed
  float same_alignment_px = 2;            // alignments of parallel lines nearer than this are one
  float min_depth_m = 0.15F;              // of the object's centre
  PoseScoreParams score;
  // Poses scored, for one model in one frame: bounds the time. Simulated kitchens need up to 1,100.
  std::uint32_t max_steps = 2'000;
};

// A pose in the rectified left frame with its coarse score.
struct Hypothesis {
  Matrix3 R = Matrix3::Identity();  // T_camera_model
  Vector3 t = Vector3::Zero();
  float score = 0;  // log-likelihood ratio of the edge samples: object at this pose against background
  std::uint16_t base_line = 0, other_line = 0;
  std::uint16_t base_edge = 0, other_edge = 0;
};

struct BetterHypothesis {
  bool operator()(const Hypothesis& p, const Hypothesis& q) const {
    if (p.score != q.score) return p.score > q.score;
    if (p.base_line != q.base_line) return p.base_line < q.base_line;
    if (p.other_line != q.other_line) return p.other_line < q.other_line;
    if (p.base_edge != q.base_edge) return p.base_edge < q.base_edge;
    if (p.other_edge != q.other_edge) return p.other_edge < q.other_edge;
    return p.t.x() < q.t.x();
  }
};
using Hypotheses = KeepBest<Hypothesis, kMaxHypotheses, BetterHypothesis>;

// All rigid motions that a corresponding pair allows. Two lines that are not parallel give the rotation in closed form:
// the other line's direction lies in the plane through camera centre and segment and at the model's angle to the base
// line, which has two solutions; the same plane fixes the position along the base line. Two parallel lines leave the
// position along them open: every alignment of end points is tried (paper: "we consider all possibilities"). Poses are
// kept when the segments lie within their projected edges, the two edges are visible from there (hidden-line table of
// the model) and the visible edges find support in both images. O(correspondences * visible edges * samples), at most
// `max_steps` poses: the pairs come by falling rank, and those for which none is left are not tried. Returns false when
// that happened.
bool MakeHypotheses(const HypothesisParams& params, const SceneEdges& scene, const PreparedModel& model,
                    const Lines3& lines, const ImageLineSets& sets, std::span<const CorrespondingPair> pairs,
                    Hypotheses& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_HYPOTHESES_H_
