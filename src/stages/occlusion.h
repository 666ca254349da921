// Stage 6: which of a pose's edges something nearer hides.
#ifndef WIREPOSE_STAGES_OCCLUSION_H_
#define WIREPOSE_STAGES_OCCLUSION_H_

#include "stages/disparity_map.h"
#include "stages/sample_edges.h"
#include "stages/surface_map.h"

namespace wirepose {

struct OcclusionParams {
  // A scene point hides the surface when its disparity exceeds the model's by more than this many pixels and this
  // share: real rigs and measured objects were seen to disagree by 3 %.
  float nearer_px = 1.5F, nearer_share = 0.05F;
};

// Removes the samples beside which the model's own surface is hidden by something nearer: an edge that cannot be seen
// says nothing. Gives the share of the samples' image length that was removed, 0..1. `samples` keep their order.
// `surface` is the model's at the same pose. O(samples).
float DropOccluded(const OcclusionParams& params, const DisparityMap& scene, const SurfaceMap& surface,
                   EdgeSamples& samples);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_OCCLUSION_H_
