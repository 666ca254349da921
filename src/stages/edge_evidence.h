// Do the images show edges where the model's visible edges are?
#ifndef WIREPOSE_STAGES_EDGE_EVIDENCE_H_
#define WIREPOSE_STAGES_EDGE_EVIDENCE_H_

#include "stages/evidence.h"

namespace wirepose {

// Fills the parts of `out` that speak of edges: edges, contrast, distinct, support, inside, visible_px, supported_edges
// and supported_faces. `eye` is the camera centre in the model frame, `samples` the model's visible edges at the pose,
// edge by edge. O(samples * profile length).
void GatherEdgeEvidence(const VerifyParams& params, const VerifyInput& input, const PreparedModel& model,
                        const Vector3& eye, const EdgeSamples& samples, Evidence& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_EDGE_EVIDENCE_H_
