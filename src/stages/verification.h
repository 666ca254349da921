// Stage 6: is the object really there? Evidence of edges, surface and outline in both images.
#ifndef WIREPOSE_STAGES_VERIFICATION_H_
#define WIREPOSE_STAGES_VERIFICATION_H_

#include "stages/evidence.h"
#include "stages/refinement.h"

namespace wirepose {

struct VerifyScratch {
  EdgeSamples samples;
  FrontTriangles front;
  SurfaceMap surface;
  RivalScratch rivals;
};

// Lines place an object but do not decide its presence: random poses reach high support in clutter. An edge supports
// when both images show it, of equal polarity and at equal offset; the same test at places beside the edges tells how
// often mere texture passes it (a-contrario, after LSD: Grompone von Gioi et al. 2012). Edges behind something nearer
// abstain, as does what lies outside an image. The scene's surface should be the model's inside the silhouette and fall
// back beside it. Image edges that overrun the model's corners are counted, and segments that cross its outline. What
// the object stands on should go on around its foot, and other sizes and poses should find fewer edges. O(samples *
// triangles + cells + edges * segments + ends * samples * places).
void GatherEvidence(const VerifyParams& params, const VerifyInput& in, const PreparedModel& model,
                    const RefinedPose& pose, VerifyScratch& scratch, Evidence& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_VERIFICATION_H_
