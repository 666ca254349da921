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

// Edges of which one face turns towards the camera and the other does not.
EdgeBits OutlineEdges(const PreparedModel& model, const Pose& T_camera_model) {
  const Vector3 eye = -(T_camera_model.R.transpose() * T_camera_model.t).cast<float>();
  EdgeBits outline{};
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    int towards = 0;
    for (const std::uint16_t face : model.view.edges[e].face) {
      if (face != kNoFace && IsTowards(model.view.faces[face], eye)) ++towards;
    }
    if (towards == 1) outline[e / 32] |= 1U << (e % 32);
  }
  return outline;
}

}  // namespace

void GatherEvidence(const VerifyParams& params, const VerifyInput& in, const PreparedModel& model,
                    const RefinedPose& pose, VerifyScratch& scratch, Evidence& out) {
  const Pose& T = pose.T_camera_model;
  SampleVisibleEdges(params.samples, in.camera, model, T, scratch.front, scratch.samples);
  RenderSurface(in.camera, model, T, scratch.surface);
  out.hidden = DropOccluded(params.occlusion, in.disparity, scratch.surface, scratch.samples);
  GatherEdgeEvidence(params, in, OutlineEdges(model, T), scratch.samples, out.edges);
  out.edges.overrun = OverrunShare(in.camera, in.left_edges, model, T, scratch.samples);
  GatherSurfaceEvidence(params.surface, in.disparity, scratch.surface, out.surface);
  out.disparity_px = MeanDisparity(scratch.samples);
  out.rms_px = pose.rms_px;
  out.uncertainty = pose.position_sigma_m / model.view.diameter_m;
}

}  // namespace wirepose
