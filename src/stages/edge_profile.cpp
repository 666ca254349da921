#include "stages/edge_profile.h"

namespace wirepose {

bool EdgeProfile::Read(const SmoothPlane& plane, int width, int height, const Vector2& p, const Vector2& normal,
                       int range) {
  middle_ = range + 2;
  count_ = 2 * middle_ + 1;
  const auto reach = static_cast<float>(middle_);
  const float rx = reach * std::abs(normal.x()), ry = reach * std::abs(normal.y());
  if (!(p.x() - rx >= 0 && p.y() - ry >= 0 && p.x() + rx < static_cast<float>(width - 1) &&
        p.y() + ry < static_cast<float>(height - 1))) {
    return false;
  }
  const float x0 = p.x() - reach * normal.x(), y0 = p.y() - reach * normal.y();
  for (int k = 0; k < count_; ++k) {
    const float x = x0 + static_cast<float>(k) * normal.x(), y = y0 + static_cast<float>(k) * normal.y();
    const int xi = static_cast<int>(x), yi = static_cast<int>(y);
    const float fx = x - static_cast<float>(xi), fy = y - static_cast<float>(yi);
    const std::int16_t* top = plane.data() + yi * kMaxImageWidth + xi;
    const std::int16_t* bottom = top + kMaxImageWidth;
    const auto t0 = static_cast<float>(top[0]), t1 = static_cast<float>(top[1]);
    const auto b0 = static_cast<float>(bottom[0]), b1 = static_cast<float>(bottom[1]);
    const float upper = t0 + fx * (t1 - t0), lower = b0 + fx * (b1 - b0);
    value_[static_cast<std::size_t>(k)] = upper + fy * (lower - upper);
  }
  return true;
}

}  // namespace wirepose
