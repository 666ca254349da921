// Does the object stand on something?
#ifndef WIREPOSE_STAGES_GROUND_EVIDENCE_H_
#define WIREPOSE_STAGES_GROUND_EVIDENCE_H_

#include "stages/disparity_map.h"
#include "stages/surface_map.h"

namespace wirepose {

struct GroundEvidenceParams {
  // A scene point lies in the plane of a face when its disparity is off by no more than this many pixels or this share.
  float tolerance_px = 1.5F, tolerance_share = 0.04F;
  std::array<float, 3> beside_px = {6, 14, 26};  // how far beyond the face's edges the scene is looked at
  float prior_votes = 4;                         // points without a vote that every share is diluted with
};

// Of the points around the face that the scene agrees with best, in its plane. Shares are 0..1.
struct GroundEvidence {
  float stands = 0;  // of what is not hidden: the scene lies in the face's plane
  float hangs = 0;   // of the same: the scene is farther, there is nothing to stand on
  float sunk = 0;    // of all: the scene is nearer, something stands there or the face lies below the ground
  float gap = 0.5F;  // mean distance of the scene from the plane that it lies in, over the tolerance; half: unknown
};

// What stands on a plane rests on a face that all of the object lies above, turned away from the camera, and the plane
// goes on around that face: on a table, on another box, on a shelf. Looks at the disparity map there, a few pixels
// beside each edge of each face that the object can stand on, outside of its silhouette. `T_camera_model` is in the
// rectified left frame, `surface` the model's own at that pose, `scene` of the same frame. Where nothing is known, or
// the model has no such face, all shares are 0 and the gap is a half. No errors, no state. O(feet * edges).
void GatherGroundEvidence(const GroundEvidenceParams& params, const RectifiedCamera& camera, const DisparityMap& scene,
                          const PreparedModel& model, const Pose& T_camera_model, const SurfaceMap& surface,
                          GroundEvidence& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_GROUND_EVIDENCE_H_
