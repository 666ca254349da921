// Do the surfaces of the scene lie where the model's are?
#ifndef WIREPOSE_STAGES_SURFACE_EVIDENCE_H_
#define WIREPOSE_STAGES_SURFACE_EVIDENCE_H_

#include "stages/disparity_map.h"
#include "stages/surface_map.h"

namespace wirepose {

struct SurfaceEvidenceParams {
  // A scene point lies on the surface when its disparity is off by no more than this many pixels or this share.
  float tolerance_px = 1.2F, tolerance_share = 0.035F;
  float drop_px = 1.5F, drop_share = 0.04F;  // beside the silhouette the scene must fall back by more than this
  float prior_cells = 5;  // cells without a vote that every share is diluted with: few cells tell little
};

// Shares of the cells whose disparity is known, 0..1.
struct SurfaceEvidence {
  float on = 0;       // of what is not hidden inside: the scene's surface is the model's
  float through = 0;  // of the same: the scene is farther, one sees through where the object should be
  float drop = 0;     // around the silhouette: the scene falls back behind the object
  float level = 0;    // around the silhouette: the surface goes on, as on a picture of an object
  float misfit = 0;   // standard deviation of the scene from the surface that it lies on, over the tolerance
};

// Compares the model's surface with the scene's inside the silhouette and 4 to 8 px around it. O(cells of the box).
void GatherSurfaceEvidence(const SurfaceEvidenceParams& params, const DisparityMap& scene, const SurfaceMap& surface,
                           SurfaceEvidence& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_SURFACE_EVIDENCE_H_
