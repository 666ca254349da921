// Stage 2, camera with depth: the registered depth image, as the disparities that a right camera would see.
#ifndef WIREPOSE_STAGES_DISPARITY_IMAGE_H_
#define WIREPOSE_STAGES_DISPARITY_IMAGE_H_

#include <array>
#include <cstdint>

#include "base/image_view.h"
#include "capacities.h"
#include "stages/disparity_map.h"
#include "stages/rectification.h"

namespace wirepose {

// Depth as a sensor gives it: z along the optical axis, registered to the grey image (same lens, same pixels); 0 where
// nothing was measured. The pixels are somebody else's.
struct DepthView {
  BasicImageView<const std::uint16_t> pixels;
  float unit_m = 0.001F;  // metres a unit
};

struct DisparityImageParams {
  // A pixel whose disparity differs from that of a neighbour by more than this many pixels and this share lies on a
  // jump of depth, where sensors mix near and far: it is taken for unknown.
  float jump_px = 1.5F, jump_share = 0.03F;
};

// Disparity of every rectified pixel.
struct DisparityImage {
  static constexpr float kOne = 64;             // stored units a pixel: up to 1023 px, which is 6 cm at f*B = 61 px*m
  static constexpr std::uint16_t kUnknown = 0;  // not measured, too near, or on a jump of depth

  int width = 0, height = 0;
  std::array<std::uint16_t, kMaxPixels> disparity;  // stride kMaxImageWidth

  [[nodiscard]] bool Contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  // px; 0 where unknown. Requires Contains(x, y).
  [[nodiscard]] float At(int x, int y) const {
    return static_cast<float>(disparity[static_cast<std::size_t>(y * kMaxImageWidth + x)]) / kOne;
  }
};

// Rectifies the depth (nearest pixel) and turns it into disparities of `camera`. `depth` has the camera's size.
// O(pixels).
void FillDisparityImage(const DisparityImageParams& params, const RectifiedCamera& camera, const RectificationMap& map,
                        const DepthView& depth, DisparityImage& out);

// The coarse map that the later stages read, as the mean of the known ones of 2 x 2 pixels. O(pixels).
void ShrinkDisparity(const DisparityImage& image, DisparityMap& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_DISPARITY_IMAGE_H_
