#include "stages/edge_profile.h"

#include "base/simd.h"

namespace wirepose {
namespace {

// Whole vectors of lanes; those beyond the profile's end are computed and not used.
constexpr std::size_t kLanes = 8;
constexpr std::size_t WholeVectors(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }
constexpr std::size_t kMaxCount = WholeVectors(2 * EdgeProfile::kMaxRange + 5);

struct Places {
  std::array<std::int32_t, kMaxCount> index;         // of the upper left pixel
  std::array<float, kMaxCount> fx, fy;               // from there
  std::array<std::uint32_t, kMaxCount> top, bottom;  // two pixels each, the left one in the lower half
};

std::uint32_t Both(const std::int16_t* p) {
  return static_cast<std::uint16_t>(p[0]) | static_cast<std::uint32_t>(static_cast<std::uint16_t>(p[1])) << 16;
}

WIREPOSE_VECTOR_KERNEL void FindPlaces(const Vector2& start, const Vector2& step, std::size_t lanes, Places& out) {
  const float x0 = start.x(), y0 = start.y(), dx = step.x(), dy = step.y();
  for (std::size_t k = 0; k < lanes; ++k) {
    const auto n = static_cast<float>(static_cast<std::int32_t>(k));
    const float x = x0 + n * dx, y = y0 + n * dy;
    const auto xi = static_cast<std::int32_t>(x), yi = static_cast<std::int32_t>(y);
    out.fx[k] = x - static_cast<float>(xi);
    out.fy[k] = y - static_cast<float>(yi);
    out.index[k] = yi * kMaxImageWidth + xi;
  }
}

// Bilinear values at the places, and their central differences.
WIREPOSE_VECTOR_KERNEL void Differentiate(const Places& places, std::size_t lanes, float* __restrict gradient) {
  std::array<float, kMaxCount> value;
  for (std::size_t k = 0; k < lanes; ++k) {
    const auto left = [](std::uint32_t both) { return static_cast<float>(static_cast<std::int16_t>(both & 0xFFFF)); };
    const auto right = [](std::uint32_t both) { return static_cast<float>(static_cast<std::int32_t>(both) >> 16); };
    const float t0 = left(places.top[k]), t1 = right(places.top[k]);
    const float b0 = left(places.bottom[k]), b1 = right(places.bottom[k]);
    const float upper = t0 + places.fx[k] * (t1 - t0), lower = b0 + places.fx[k] * (b1 - b0);
    value[k] = upper + places.fy[k] * (lower - upper);
  }
  gradient[0] = gradient[lanes - 1] = 0;
  for (std::size_t k = 1; k < lanes - 1; ++k) gradient[k] = value[k + 1] - value[k - 1];
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
  const std::size_t lanes = WholeVectors(static_cast<std::size_t>(count_));
  Places places;
  FindPlaces({p.x() - reach * normal.x(), p.y() - reach * normal.y()}, normal, lanes, places);
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    const std::int16_t* top = plane.data() + places.index[k];
    const std::int16_t* bottom = top + kMaxImageWidth;
    places.top[k] = Both(top);
    places.bottom[k] = Both(bottom);
  }
  for (auto k = static_cast<std::size_t>(count_); k < lanes; ++k) places.top[k] = places.bottom[k] = 0;
  Differentiate(places, lanes, gradient_.data());
  return true;
}

}  // namespace wirepose
