// A straight edge in one rectified image.
#ifndef WIREPOSE_GEOMETRY_SEGMENT2_H_
#define WIREPOSE_GEOMETRY_SEGMENT2_H_

#include "geometry/se3.h"

namespace wirepose {

// From `a` to `b`, in rectified pixels, with the brighter side to the right of the direction of travel (x right,
// y down: the normal (-dy, dx) points to the brighter side). So a segment and its copy with inverted contrast differ.
struct Segment2 {
  Vector2 a = Vector2::Zero(), b = Vector2::Zero();
  float contrast = 0;         // mean gradient magnitude across the edge, grey levels per pixel
  float sigma_offset_px = 0;  // standard deviation of the normal offset at the middle
  float sigma_angle_rad = 0;  // standard deviation of the direction

  [[nodiscard]] Vector2 Delta() const { return b - a; }
  [[nodiscard]] float Length() const { return (b - a).norm(); }
  [[nodiscard]] Vector2 Direction() const { return (b - a) / (b - a).norm(); }
  // Unit normal, towards the brighter side.
  [[nodiscard]] Vector2 Normal() const {
    const Vector2 d = Direction();
    return {-d.y(), d.x()};
  }
  [[nodiscard]] Vector2 Middle() const { return 0.5F * (a + b); }
};

}  // namespace wirepose

#endif  // WIREPOSE_GEOMETRY_SEGMENT2_H_
