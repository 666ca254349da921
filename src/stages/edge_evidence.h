// Do the images show edges where the model's visible edges are?
#ifndef WIREPOSE_STAGES_EDGE_EVIDENCE_H_
#define WIREPOSE_STAGES_EDGE_EVIDENCE_H_

#include "stages/evidence.h"

namespace wirepose {

// All of `out` but `overrun` and `crossed`, from the model's visible edges at the pose, edge by edge. O(samples *
// profile length).
void GatherEdgeEvidence(const VerifyParams& params, const VerifyInput& input, const PreparedModel& model,
                        const Pose& T_camera_model, const EdgeSamples& samples, EdgeEvidence& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_EDGE_EVIDENCE_H_
