#include "sim/lens.h"

#include <Eigen/LU>

namespace wirepose::sim {

Vector2d Lens::Distort(const Vector2d& xy, Matrix2d* jacobian) const {
  // Brown (1966) in OpenCV's notation: x' = x radial + 2 p1 x y + p2 (r2 + 2 x^2), y' likewise with
  // p1, p2 exchanged.
  const double x = xy.x(), y = xy.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (c_.k1 + r2 * (c_.k2 + r2 * c_.k3));
  if (jacobian != nullptr) {
    const double slope = 2 * (c_.k1 + r2 * (2 * c_.k2 + r2 * 3 * c_.k3));  // d radial / d x = slope x
    const double mixed = slope * x * y + 2 * c_.p1 * x + 2 * c_.p2 * y;
    *jacobian << radial + slope * x * x + 2 * c_.p1 * y + 6 * c_.p2 * x, mixed, mixed,
        radial + slope * y * y + 6 * c_.p1 * y + 2 * c_.p2 * x;
  }
  return {x * radial + 2 * c_.p1 * x * y + c_.p2 * (r2 + 2 * x * x),
          y * radial + c_.p1 * (r2 + 2 * y * y) + 2 * c_.p2 * x * y};
}

Vector2d Lens::PixelOf(const Vector2d& xy) const {
  const Vector2d d = Distort(xy, nullptr);
  return {c_.fx * d.x() + c_.cx, c_.fy * d.y() + c_.cy};
}

std::optional<Lens::Ray> Lens::RayOf(const Vector2d& pixel) const {
  const Vector2d goal((pixel.x() - c_.cx) / c_.fx, (pixel.y() - c_.cy) / c_.fy);
  Ray ray{goal, Matrix2d::Identity()};
  constexpr int kMaxSteps = 30;
  for (int i = 0; i < kMaxSteps; ++i) {
    Matrix2d J;
    const Vector2d error = Distort(ray.xy, &J) - goal;
    // Beyond the fold the derivative changes its sign: no light gets there.
    if (!(J.determinant() > 0) || !(J(0, 0) > 0)) return std::nullopt;
    const Matrix2d inverse = J.inverse();
    if (error.squaredNorm() < 1e-26) {
      ray.dxy_dpixel = inverse * Vector2d(1 / c_.fx, 1 / c_.fy).asDiagonal();
      return ray;
    }
    ray.xy -= inverse * error;
  }
  return std::nullopt;
}

}  // namespace wirepose::sim
