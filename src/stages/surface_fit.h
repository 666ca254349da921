// Stage 7, helper: measured surfaces pull the model's visible faces onto them.
#ifndef WIREPOSE_STAGES_SURFACE_FIT_H_
#define WIREPOSE_STAGES_SURFACE_FIT_H_

#include <cstdint>

#include "base/fixed_vector.h"
#include "stages/disparity_map.h"
#include "stages/sample_edges.h"

namespace wirepose {

struct SurfaceFitParams {
  // Whether the disparity map of a stereo pair is used as well. A camera with depth always uses it: a single image
  // tells distance by size alone.
  bool in_stereo = false;
  float step_px = 6;         // between samples; widened when the object would need more than kMaxSurfaceSamples
  float margin_px = 5;       // from visible edges: sensors round them off
  float min_cosine = 0.25F;  // between a face's normal and the line of sight: flatter faces say little
  // Measurements that are off by more than this many pixels and this share are of another surface.
  float max_residual_px = 5, max_residual_share = 0.06F;
  float sigma_floor_px = 0.2F;
  // Standard deviations of disparity that weights and covariance are made of: of a sample (twice what is seen of one
  // sample, since neighbours share errors), of a face (all of whose samples share it), of all faces together (also as a
  // share), and how much of the observed scatter of the faces' mean residuals (a variance) is added to that of a face.
  float noise_px = 0.8F, face_px = 0.3F, common_px = 0.2F, common_share = 0.003F, scatter_gain = 2;
};

// A point on a visible face, where the map has a value of its own.
struct SurfaceSample {
  Vector2 pixel;  // middle of the map's cell, full image
  std::uint16_t face = 0;
};
using SurfaceSamples = FixedVector<SurfaceSample, kMaxSurfaceSamples>;

// A measured disparity with its derivative by the twist of PerturbLeft about the model origin.
struct SurfaceRow {
  Vector6d J = Vector6d::Zero();
  double residual = 0;               // px, measured minus predicted
  Vector6d pull = Vector6d::Zero();  // what the normal equations' right side gets of each px of the residual
  double weight = 0;                 // robust, 0..1
  double sigma = 1;                  // px, of what all faces have in common
  std::uint16_t face = 0;
};
using SurfaceRows = FixedVector<SurfaceRow, kMaxSurfaceSamples>;

// Picks cells of the map on the faces that the camera sees at the pose, away from visible edges (`edges`, of the same
// pose) and ordered by face. `front` is work space. O(faces * triangles + samples * (edges + triangles)).
void SampleSurface(const SurfaceFitParams& params, const RectifiedCamera& camera, const PreparedModel& model,
                   const Pose& T_camera_model, const EdgeSamples& edges, FrontTriangles& front, SurfaceSamples& out);

// Point-to-plane residuals (Chen & Medioni 1992) in disparity, where their errors are nearly Gaussian: what the map
// shows at each sample's pixel against the disparity of the sample's face there, with Geman-McClure weights. What the
// samples of a face have in common may be the sensor's bias: each face has one as an unknown of its own, with a prior,
// which is eliminated. So a face's tilt counts for much, its distance for what the bias allows. Rows follow each other
// by face. O(samples).
void MeasureSurface(const SurfaceFitParams& params, const RectifiedCamera& camera, const PreparedModel& model,
                    const Pose& T_camera_model, const DisparityMap& map, const SurfaceSamples& samples,
                    SurfaceRows& out);

// Adds the rows to a normal matrix and its right side. `unit_variance` is the variance [px^2] for which an edge's
// sample has weight 1 there. O(rows).
void AddSurface(const SurfaceRows& rows, double unit_variance, Matrix6d& H, Vector6d& g);

// Covariance of the sum that AddSurface adds to the right side. Errors are shared: by the samples of a face, and by all
// of them (the sensor's calibration). O(rows).
Matrix6d SpreadOfSurface(const SurfaceFitParams& params, const SurfaceRows& rows, double unit_variance);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_SURFACE_FIT_H_
