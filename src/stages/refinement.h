// Stage 7: local adjustment (paper section 4): the pose moves until the model's edges lie on the image's edges.
#ifndef WIREPOSE_STAGES_REFINEMENT_H_
#define WIREPOSE_STAGES_REFINEMENT_H_

#include "stages/edge_image.h"
#include "stages/offset_equations.h"
#include "stages/sample_edges.h"
#include "stages/surface_fit.h"

namespace wirepose {

struct RefineParams {
  int iterations = 6;
  SampleParams samples{.step_px = 8};
  float first_range_px = 8;  // 1D search along the edge normal; shrinks to last_range_px
  float last_range_px = 2;
  float min_gradient = 1.0F;         // grey levels per pixel: weaker edges are not followed
  float min_qualified_share = 0.4F;  // an edge with less support than this does not pull in the last iterations
  float max_rms_px = 1.25F;          // what fits worse after all iterations is no fit
  float sigma_floor_px = 0.3F;
  OffsetErrors errors{};
  SurfaceFitParams surface{};
};

// Smoothed rectified images, and the surfaces between the edges where they are to be used.
struct SceneImages {
  const RectifiedCamera& camera;
  const SmoothPlane& left;
  const SmoothPlane& right;               // not read when the camera has no right image
  const DisparityMap* surface = nullptr;  // null: edges alone
};

struct RefineScratch {
  EdgeSamples samples;
  FrontTriangles front;
  SurfaceSamples surface_samples;
  SurfaceRows surface_rows;
};

struct RefinedPose {
  Pose T_camera_model;
  Matrix6d covariance = Matrix6d::Identity();  // of PerturbLeft about the model origin: rotation, translation
  float rms_px = 0;                            // of the offsets that remain, weighted
  float position_sigma_m =
      0;               // of the position, by the normal matrix and the samples' scatter: what the edges determine
  float shift_px = 0;  // length of the right image's estimated shift against the left one; 0 without it
  std::uint16_t inliers = 0;  // samples of both images within three sigma
  bool ok = false;            // enough edges were found, they fit, and the normal matrix had full rank
};

// Robust Gauss-Newton on SE(3). The closest image feature of eq. 11 is searched along the normal of the projected edge
// (RAPiD: Harris & Stennett 1990) in both images; all offsets enter one normal matrix, with Geman-McClure weights and
// by how their errors hang together (offset_equations.h). The search range shrinks from iteration to iteration; hidden
// lines are found at the start and anew half way. Only qualified features count at the end: edges of which a good share
// was found. With a disparity map the visible faces are drawn onto the measured surfaces by the same steps
// (surface_fit.h). The covariance is the sandwich estimate for clustered errors (Liang & Zeger 1986): samples share the
// errors of their edge and of their image. `ok` is false, and the pose the start, where fewer than 12 offsets are found
// or they do not determine it. No heap, no state. O(iterations * samples * range).
void RefinePose(const RefineParams& params, const SceneImages& images, const PreparedModel& model, const Pose& start,
                RefineScratch& scratch, RefinedPose& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_REFINEMENT_H_
