// A 3D line as stereo sees it: an image segment with a disparity at each end, or without depth.
#ifndef WIREPOSE_GEOMETRY_LINE3_H_
#define WIREPOSE_GEOMETRY_LINE3_H_

#include <cstdint>

#include "geometry/camera.h"
#include "geometry/segment2.h"

namespace wirepose {

// Which side of the edge carries the depth: an occluding edge belongs to its near side.
enum class LineOwner : std::uint8_t { kBoth, kBright, kDark };

// Disparity is linear along an image line, so two numbers place it in space. Their covariance is kept in disparity,
// where it is nearly Gaussian; it grows with depth squared when turned into metres.
struct Line3 {
  std::uint16_t id = 0;    // index of its segment among those matched in the left image
  bool has_depth = false;  // false: only the plane through camera centre and segment is known
  LineOwner owner = LineOwner::kBoth;
  Segment2 segment;                                  // left rectified image
  float disparity_a_px = 0;                          // at segment.a; valid when has_depth, as all below
  float disparity_b_px = 0;                          // at segment.b
  float var_a = 0, var_b = 0, cov_ab = 0;            // px^2, of the two disparities
  Vector3 a = Vector3::Zero(), b = Vector3::Zero();  // end points, rectified left camera frame, m

  [[nodiscard]] Vector3 Direction() const { return (b - a).normalized(); }
  [[nodiscard]] float Length() const { return (b - a).norm(); }
};

// Sets the end points and has_depth from the disparities; what is farther than a disparity of 1 px stays without depth.
inline void PlaceInSpace(const RectifiedCamera& camera, Line3& line) {
  if (!(line.disparity_a_px >= 1 && line.disparity_b_px >= 1)) return;
  const auto point = [&](const Vector2& p, float d) -> Vector3 {
    return camera.Triangulate(static_cast<double>(p.x()), static_cast<double>(p.y()), static_cast<double>(d))
        .cast<float>();
  };
  line.a = point(line.segment.a, line.disparity_a_px);
  line.b = point(line.segment.b, line.disparity_b_px);
  line.has_depth = true;
}

}  // namespace wirepose

#endif  // WIREPOSE_GEOMETRY_LINE3_H_
