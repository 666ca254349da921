#include "stages/edge_profile.h"

#include "base/simd.h"

namespace wirepose {
namespace {

// Whole vectors of lanes; those beyond the profile's end are computed and not used.
constexpr std::size_t kLanes = (2 * EdgeProfile::kMaxRange + 5 + 7) / 8 * 8;

struct Places {
  std::array<std::int32_t, kLanes> index;         // of the upper left pixel
  std::array<float, kLanes> fx, fy;               // from there
  std::array<std::uint32_t, kLanes> top, bottom;  // two pixels each, the left one in the lower half
};

std::uint32_t Both(const std::int16_t* p) {
  return static_cast<std::uint16_t>(p[0]) | static_cast<std::uint32_t>(static_cast<std::uint16_t>(p[1])) << 16;
}

WIREPOSE_VECTOR_KERNEL void Place(const Vector2& start, const Vector2& step, Places& out) {
  const float x0 = start.x(), y0 = start.y(), dx = step.x(), dy = step.y();
  for (std::size_t k = 0; k < kLanes; ++k) {
    const auto n = static_cast<float>(static_cast<std::int32_t>(k));
    const float x = x0 + n * dx, y = y0 + n * dy;
    const auto xi = static_cast<std::int32_t>(x), yi = static_cast<std::int32_t>(y);
    out.fx[k] = x - static_cast<float>(xi);
    out.fy[k] = y - static_cast<float>(yi);
    out.index[k] = yi * kMaxImageWidth + xi;
  }
}

WIREPOSE_VECTOR_KERNEL void Blend(const Places& places, float* value) {
  for (std::size_t k = 0; k < kLanes; ++k) {
    const auto left = [](std::uint32_t both) { return static_cast<float>(static_cast<std::int16_t>(both & 0xFFFF)); };
    const auto right = [](std::uint32_t both) { return static_cast<float>(static_cast<std::int32_t>(both) >> 16); };
    const float t0 = left(places.top[k]), t1 = right(places.top[k]);
    const float b0 = left(places.bottom[k]), b1 = right(places.bottom[k]);
    const float upper = t0 + places.fx[k] * (t1 - t0), lower = b0 + places.fx[k] * (b1 - b0);
    value[k] = upper + places.fy[k] * (lower - upper);
  }
}

}  // namespace

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
  Places places;
  Place({p.x() - reach * normal.x(), p.y() - reach * normal.y()}, normal, places);
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    const std::int16_t* top = plane.data() + places.index[k];
    const std::int16_t* bottom = top + kMaxImageWidth;
    places.top[k] = Both(top);
    places.bottom[k] = Both(bottom);
  }
  for (auto k = static_cast<std::size_t>(count_); k < kLanes; ++k) places.top[k] = places.bottom[k] = 0;
  Blend(places, value_.data());
  return true;
}

}  // namespace wirepose
