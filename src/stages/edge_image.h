// Stage 1a: smoothed image, gradient and edge ridges. Everything later looks at these planes, never at raw pixels.
#ifndef WIREPOSE_STAGES_EDGE_IMAGE_H_
#define WIREPOSE_STAGES_EDGE_IMAGE_H_

#include <array>
#include <cstdint>

#include "base/image_view.h"
#include "capacities.h"
#include "stages/rectification.h"

namespace wirepose {

inline constexpr int kStride = kMaxImageWidth;  // elements from one row of any image plane to the next

struct EdgeImageParams {
  // A ridge pixel's gradient must exceed this multiple of the image's gradient noise ...
  float noise_factor = 2.3F;
  // ... and this floor [grey levels per pixel], below which 8 bit quantisation makes edges of its own.
  float min_gradient = 0.6F;
};

// Fixed point of the smoothed image: grey levels times 16, exactly what the 5-tap binomial filter leaves.
inline constexpr int kSmoothOne = 16;
// Fixed point of the gradient: grey levels per pixel times 32 (a central difference spans two pixels).
inline constexpr int kGradientOne = 32;

// Which way an edge pixel's neighbours were compared when the ridge was found.
enum class Ridge : std::uint8_t { kNone = 0, kAcrossX = 1, kAcrossY = 2 };

// Planes of one image at stride kMaxImageWidth. 2.6 MB; the pipeline keeps one and reuses it for both eyes.
struct EdgeImage {
  int width = 0, height = 0;
  std::array<std::int16_t, kMaxPixels> gx, gy;              // kGradientOne
  std::array<std::uint16_t, kMaxPixels> magnitude;          // kGradientOne
  std::array<std::uint8_t, kMaxPixels> ridge;               // Ridge
  std::array<std::uint32_t, kMaxRidgePixels> ridge_pixels;  // in the order of rows
  std::array<std::uint32_t, kMaxRidgePixels> by_magnitude;  // the same, after SortRidges
  std::uint32_t ridge_count = 0;
  std::uint32_t ridge_dropped = 0;
  std::uint16_t threshold = 0;  // magnitude from which on a pixel may be a ridge

  static constexpr std::size_t Index(int x, int y) {
    return static_cast<std::size_t>(y) * kMaxImageWidth + static_cast<std::size_t>(x);
  }
};

using SmoothPlane = std::array<std::int16_t, kMaxPixels>;  // kSmoothOne, stride kMaxImageWidth

// Smooths with the binomial filter 1 4 6 4 1 in both directions (sigma 1 px). O(pixels), integers only.
void SmoothImage(ImageView image, SmoothPlane& smooth);

// Gradient by central differences, its noise from the median magnitude, and ridges: pixels whose magnitude exceeds that
// of both neighbours across the edge (non-maximum suppression along the larger gradient component). Pixels within 3 of
// the valid interval's end or the image border are no ridges. O(pixels).
void FindRidges(const SmoothPlane& smooth, int width, int height, const RectificationMap& map,
                const EdgeImageParams& params, EdgeImage& out);

// Fills by_magnitude: strongest first, those of one strength (to half a grey level) in the order of rows. O(ridges).
void SortRidges(EdgeImage& image);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_EDGE_IMAGE_H_
