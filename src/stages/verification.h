// Stage 6: is the object really there? Evidence of edges, faces and silhouette in both images.
#ifndef WIREPOSE_STAGES_VERIFICATION_H_
#define WIREPOSE_STAGES_VERIFICATION_H_

#include "stages/evidence.h"

namespace wirepose {

struct VerifyScratch {
  EdgeSamples samples;
  FrontTriangles front;
  SurfaceMap surface;
};

// Lines place an object but do not decide its presence: random poses reach high support in clutter. So evidence grows
// with length against the frame's background rate, unsupported edges count against, and the same test at places beside
// the edges tells how often mere texture passes it (a-contrario, after LSD: Grompone von Gioi et al. 2012). An edge
// supports when both images show it, of equal polarity and at equal offset. Each face must be photo-consistent at its
// own depth rather than at others (textured faces vote, blank ones abstain). Image edges that overrun the model's
// corners are counted. What lies outside an image abstains. O(samples * triangles + patches).
void GatherEvidence(const VerifyParams& params, const VerifyInput& input, const PreparedModel& model,
                    const Pose& T_camera_model, VerifyScratch& scratch, Evidence& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_VERIFICATION_H_
