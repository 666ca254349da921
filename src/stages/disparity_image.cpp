#include "stages/disparity_image.h"

#include <algorithm>
#include <cmath>

namespace wirepose {
namespace {

using DisparityRow = std::array<std::uint16_t, kMaxImageWidth>;

// Depth units become disparity units, in place.
void ToDisparity(float numerator, int width, std::uint16_t* row) {
  constexpr float kLargest = 65535;
  for (int x = 0; x < width; ++x) {
    if (row[x] == 0) continue;
    const float disparity = numerator / static_cast<float>(row[x]) + 0.5F;
    row[x] = disparity < kLargest ? static_cast<std::uint16_t>(disparity) : DisparityImage::kUnknown;
  }
}

bool IsJump(const DisparityImageParams& params, std::uint16_t here, std::uint16_t neighbour) {
  if (neighbour == DisparityImage::kUnknown) return false;
  const float d = here, n = neighbour;
  return std::abs(d - n) > std::max(params.jump_px * DisparityImage::kOne, params.jump_share * std::max(d, n));
}

// `above`, `here` and `below` are rows as measured; those outside of the image repeat `here`.
void DropJumps(const DisparityImageParams& params, int width, const DisparityRow& above, const DisparityRow& here,
               const std::uint16_t* below, std::uint16_t* out) {
  for (int x = 0; x < width; ++x) {
    const auto i = static_cast<std::size_t>(x);
    const std::uint16_t d = here[i];
    if (d == DisparityImage::kUnknown) continue;
    const bool jump = (x > 0 && IsJump(params, d, here[i - 1])) || (x + 1 < width && IsJump(params, d, here[i + 1])) ||
                      IsJump(params, d, above[i]) || IsJump(params, d, below[x]);
    if (jump) out[x] = DisparityImage::kUnknown;
  }
}

}  // namespace

void FillDisparityImage(const DisparityImageParams& params, const RectifiedCamera& camera, const RectificationMap& map,
                        const DepthView& depth, DisparityImage& out) {
  out.width = camera.width;
  out.height = camera.height;
  RectifyDepth(depth.pixels, map, out.width, out.height, out.disparity.data());
  const auto row = [&](int y) { return out.disparity.data() + static_cast<std::ptrdiff_t>(y) * kMaxImageWidth; };
  const auto numerator = static_cast<float>(camera.f * camera.baseline * static_cast<double>(DisparityImage::kOne) /
                                            static_cast<double>(depth.unit_m));
  for (int y = 0; y < out.height; ++y) ToDisparity(numerator, out.width, row(y));
  DisparityRow above, here;
  std::copy_n(row(0), out.width, here.begin());
  for (int y = 0; y < out.height; ++y) {
    above = here;  // of the row before, as measured
    std::copy_n(row(y), out.width, here.begin());
    if (y == 0) above = here;
    DropJumps(params, out.width, above, here, row(std::min(y + 1, out.height - 1)), row(y));
  }
}

void ShrinkDisparity(const DisparityImage& image, DisparityMap& out) {
  constexpr int kScale = DisparityMap::kScale;
  constexpr int kUnits = static_cast<int>(DisparityImage::kOne / DisparityMap::kOne);
  static_assert(kScale == 2);
  out.width = image.width / kScale;
  out.height = image.height / kScale;
  for (int j = 0; j < out.height; ++j) {
    const std::uint16_t* top = image.disparity.data() + static_cast<std::ptrdiff_t>(kScale * j) * kMaxImageWidth;
    const std::uint16_t* bottom = top + kMaxImageWidth;
    std::uint16_t* row = out.disparity.data() + static_cast<std::ptrdiff_t>(j) * DisparityMap::kMaxWidth;
    for (int i = 0; i < out.width; ++i) {
      const std::array<int, 4> pixels = {top[2 * i], top[2 * i + 1], bottom[2 * i], bottom[2 * i + 1]};
      int sum = 0, known = 0;
      for (const int d : pixels) {
        sum += d;
        known += d != 0 ? 1 : 0;
      }
      const int half = known * kUnits / 2;
      row[i] = static_cast<std::uint16_t>(known == 0 ? 0 : (sum + half) / (known * kUnits));
    }
  }
}

}  // namespace wirepose
