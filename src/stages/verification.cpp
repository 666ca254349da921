#include "stages/verification.h"

#include "stages/edge_evidence.h"
#include "stages/overrun.h"

namespace wirepose {
namespace {

float MeanDisparity(const EdgeSamples& samples) {
  float sum = 0;
  for (const EdgeSample& s : samples) sum += s.disparity;
  return samples.empty() ? 0 : sum / static_cast<float>(samples.size());
}

}  // namespace

void GatherEvidence(const VerifyParams& params, const VerifyInput& in, const PreparedModel& model,
                    const RefinedPose& pose, VerifyScratch& scratch, Evidence& out) {
  const Pose& T = pose.T_camera_model;
  SampleVisibleEdges(params.samples, in.camera, model, T, scratch.front, scratch.samples);
  RenderSurface(in.camera, model, T, scratch.surface);
  out.hidden = DropOccluded(params.occlusion, in.disparity, scratch.surface, scratch.samples);
  GatherEdgeEvidence(params, in, model, T, scratch.samples, out.edges);
  const Overrun overrun = MeasureOverrun(in.camera, in.left_edges, model, T, EdgesOf(scratch.samples));
  out.edges.overrun = overrun.share;
  out.edges.crossed = overrun.crossed;
  GatherLineEvidence(params.lines, in.camera, in.segments, model, T, scratch.samples, scratch.surface, out.lines);
  GatherSurfaceEvidence(params.surface, in.disparity, scratch.surface, out.surface);
  GatherGroundEvidence(params.ground, in.camera, in.disparity, model, T, scratch.surface, out.ground);
  GatherRivalEvidence(params.rivals, in.camera, in.left_edges, in.right_edges, model, T, scratch.samples,
                      scratch.rivals, out.rivals);
  out.disparity_px = MeanDisparity(scratch.samples);
  out.rms_px = pose.rms_px;
  out.shift_px = pose.shift_px;
  out.uncertainty = pose.position_sigma_m / model.view.diameter_m;
}

}  // namespace wirepose
