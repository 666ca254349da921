// Model edges as an observer sees them: sample points along the parts that are not hidden.
#ifndef WIREPOSE_STAGES_SAMPLE_EDGES_H_
#define WIREPOSE_STAGES_SAMPLE_EDGES_H_

#include <cstdint>

#include "base/fixed_vector.h"
#include "geometry/camera.h"
#include "model/prepared_model.h"

namespace wirepose {

// A point of a visible model edge in the rectified pair.
struct EdgeSample {
  Vector3 point;          // model frame, m
  Vector2 left;           // px
  float disparity;        // px
  Vector2 tangent;        // unit, of the projected edge in the left image
  Vector2 tangent_right;  // and in the right image
  std::uint16_t edge;
  float weight_px;  // image length that the sample stands for
};

using EdgeSamples = FixedVector<EdgeSample, kMaxEdgeSamples>;

struct SampleParams {
  float step_px = 5;          // between samples; widened when the object would need more than kMaxEdgeSamples
  float min_edge_px = 8;      // shorter projections carry no direction
  float max_depth_ratio = 8;  // edges that come closer than depth / ratio are left out: they run through the camera
};

// A triangle that faces the camera: all that can hide anything. With its bounding box in the left image.
struct FrontTriangle {
  std::uint16_t triangle = 0;
  Vector2 low = Vector2::Zero(), high = Vector2::Zero();  // px
};
using FrontTriangles = FixedVector<FrontTriangle, kMaxModelTriangles>;

// Samples the edges of `model` that the left camera sees at T_camera_model (paper section 3.2: "features connected to
// the hidden faces can be removed"): edges with at least one face towards the camera, point by point tested against
// the model's own front faces. Convex models need no such test. Points outside the image are included: the caller
// decides what lies outside of which image. O(edges * samples * triangles) with concave models.
void SampleVisibleEdges(const SampleParams& params, const RectifiedCamera& camera, const PreparedModel& model,
                        const Pose& T_camera_model, FrontTriangles& scratch, EdgeSamples& out);

// True when a front triangle other than those of faces `a` and `b` lies between `eye` and `point` (model frame), which
// appears at `image` in the left image. O(front triangles).
bool IsHidden(const ModelView& model, const FrontTriangles& front, const Vector3& eye, const Vector3& point,
              const Vector2& image, std::uint16_t a, std::uint16_t b);

// The triangles that face the camera at T_camera_model.
void FindFrontTriangles(const RectifiedCamera& camera, const ModelView& model, const Pose& T_camera_model,
                        FrontTriangles& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_SAMPLE_EDGES_H_
