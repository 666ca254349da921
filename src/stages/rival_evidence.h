// Stage 6: would the same edges be found as well by an object of another size, or by this one at another pose?
#ifndef WIREPOSE_STAGES_RIVAL_EVIDENCE_H_
#define WIREPOSE_STAGES_RIVAL_EVIDENCE_H_

#include <cstdint>

#include "geometry/camera.h"
#include "model/prepared_model.h"
#include "stages/edge_map.h"
#include "stages/sample_edges.h"

namespace wirepose {

struct RivalEvidenceParams {
  float reach = 0.25F;    // how far an end or the object is moved, of the diameter
  float step_px = 4;      // between the places that are looked at: what an edge map's cells reach to both sides
  float min_move_px = 6;  // nearer places see the edge itself
  float min_end_px = 30;  // visible edges around an end; fewer tell nothing
  // Angles that the object is turned by, to each side.
  float min_turn_rad = 0.09F, max_turn_rad = 0.36F;
  int turns = 6;
};

// Support is the share of samples of visible edges that find an image edge of their direction in both images. Right
// poses have more of it than all about them; poses on texture, tiles or something larger do not. Gains are how much
// more support the best rival has, at least 0; peaks are support above the mean of the rivals, 1 without any.
//
// Ends are the faces that all of the object lies behind. On an object of another size all edges but those of one end
// agree, and that end's edges are seen some way along its normal.
struct RivalEvidence {
  float inward = 0;       // gain of an end that is moved inward, at the best place of the best end
  float outward = 0;      // the same outward
  float rival = 0;        // support of the better of both
  float own = 0;          // support of the same end where it is
  float left = 0;         // highest gain of an end in the left image alone
  float end_peak = 1;     // of the end that stands out least
  float moved = 0;        // gain of the whole object, moved along the normal of an end
  float moved_peak = 1;   // of the normal along which it stands out least
  float turned = 0;       // gain of the whole object, turned about such a normal through its centre
  float turned_peak = 1;  // of the normal about which it stands out least
};

struct RivalScratch {
  // A sample of a visible edge in the rectified left camera, and the directions of its edge in both images (EdgeMap's).
  struct Sample {
    Vector3 at;  // m
    std::uint16_t edge = 0;
    std::uint8_t direction = 0, direction_right = 0;
  };
  FixedVector<Sample, kMaxEdgeSamples> all, part;
};

// `samples`: of the edges that are seen at T_camera_model (rectified left camera), in the order of edges; every second
// one is looked at. Where the right image does not reach, or there is none, the left one alone decides. Nothing seen
// gives gains of 0 and peaks of 1. No heap. O(ends * samples * (places + turns)).
void GatherRivalEvidence(const RivalEvidenceParams& params, const RectifiedCamera& camera, const EdgeMap& left,
                         const EdgeMap& right, const PreparedModel& model, const Pose& T_camera_model,
                         const EdgeSamples& samples, RivalScratch& scratch, RivalEvidence& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_RIVAL_EVIDENCE_H_
