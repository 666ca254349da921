// From sums over the samples of each edge to the evidence of all edges together.
#ifndef WIREPOSE_STAGES_EDGE_SUMMARY_H_
#define WIREPOSE_STAGES_EDGE_SUMMARY_H_

#include <span>

#include "stages/edge_sums.h"
#include "stages/evidence.h"

namespace wirepose {

// All of `out` but `overrun` and `crossed`. `sums`: of each model edge, by its index; zero where it has no samples.
// `total_px`: image length of the visible edges, also of what lies outside of the image. O(edges).
void SummarizeEdges(const VerifyParams& params, const PreparedModel& model, const Pose& T_camera_model,
                    std::span<const EdgeSums> sums, float total_px, EdgeEvidence& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_EDGE_SUMMARY_H_
