// The camera as a map between pixels and directions: pinhole with Brown-Conrady distortion. Written
// independently of src/, so that a mistake there cannot hide here.
#ifndef WIREPOSE_SIM_LENS_H_
#define WIREPOSE_SIM_LENS_H_

#include <optional>

#include "geometry/camera.h"

namespace wirepose::sim {

using Matrix2d = Eigen::Matrix2d;
using Vector2d = Eigen::Vector2d;

// A direction in the camera frame is (x, y, 1) with `xy` = (x, y).
class Lens {
 public:
  explicit Lens(const CameraIntrinsics& intrinsics) : c_(intrinsics) {}

  // The pixel at which the direction is seen. With strong distortion far off the axis the
  // polynomial folds back; PixelOf does not notice, RayOf does.
  [[nodiscard]] Vector2d PixelOf(const Vector2d& xy) const;

  struct Ray {
    Vector2d xy;
    Matrix2d dxy_dpixel;  // how the direction changes from pixel to pixel
  };
  // The direction that is seen at a pixel, to 1e-12; nothing where the lens model has none.
  [[nodiscard]] std::optional<Ray> RayOf(const Vector2d& pixel) const;

 private:
  // Distorted normalised coordinates and their derivative by the undistorted ones.
  [[nodiscard]] Vector2d Distort(const Vector2d& xy, Matrix2d* jacobian) const;

  CameraIntrinsics c_;
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_LENS_H_
