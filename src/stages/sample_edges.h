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

// The edges that have a sample.
inline EdgeBits EdgesOf(const EdgeSamples& samples) {
  EdgeBits edges{};
  for (const EdgeSample& s : samples) edges[s.edge / 32] |= 1U << (s.edge % 32);
  return edges;
}

struct SampleParams {
  float step_px = 5;          // between samples; widened when the object would need more than kMaxEdgeSamples
  float min_edge_px = 8;      // shorter projections carry no direction
  float max_depth_ratio = 8;  // edges that come closer than depth / ratio are left out: they run through the camera
};

// A triangle (a, a + p, a + q) that faces the camera: all that can hide anything. With its bounding box in the left
// image, and what is the same for all rays from the eye: a ray r meets the plane at h / (r d) of its length, and the
// triangle where r u >= 0, r v >= 0 and r u + r v <= r d. (Moeller & Trumbore 1997, for one origin.)
struct FrontTriangle {
  std::uint16_t triangle = 0, face = 0;
  Vector2 low = Vector2::Zero(), high = Vector2::Zero();                  // px
  Vector3 d = Vector3::Zero(), u = Vector3::Zero(), v = Vector3::Zero();  // m^2, model frame
  float h = 0;                                                            // m^3

  // True when it lies between the eye and the end of `ray`, which appears at `image`. What is nearer to the end than 3
  // per mille of the distance belongs to the end itself.
  [[nodiscard]] bool Hides(const Vector3& ray, const Vector2& image) const {
    if (image.x() < low.x() || image.y() < low.y() || image.x() > high.x() || image.y() > high.y()) return false;
    const float rd = ray.dot(d), ru = ray.dot(u), rv = ray.dot(v);
    return h < 0.997F * rd && ru >= 0 && rv >= 0 && ru + rv <= rd;
  }
};
using FrontTriangles = FixedVector<FrontTriangle, kMaxModelTriangles>;

// Samples the edges of `model` that the left camera sees at T_camera_model (paper section 3.2: "features connected to
// the hidden faces can be removed"): edges with at least one face towards the camera, point by point tested against
// the model's own front faces. Convex models need no such test. Points outside the image are included: the caller
// decides what lies outside of which image. O(edges * samples * triangles) with concave models.
void SampleVisibleEdges(const SampleParams& params, const RectifiedCamera& camera, const PreparedModel& model,
                        const Pose& T_camera_model, FrontTriangles& scratch, EdgeSamples& out);

// True when a front triangle of another face than `face` hides the end of `ray` from the eye (model frame), which
// appears at `image` in the left image. O(front triangles).
bool IsHidden(const FrontTriangles& front, const Vector3& ray, const Vector2& image, std::uint16_t face);

// The triangles that face the camera at T_camera_model.
void FindFrontTriangles(const RectifiedCamera& camera, const ModelView& model, const Pose& T_camera_model,
                        FrontTriangles& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_SAMPLE_EDGES_H_
