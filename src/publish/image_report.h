// The picture behind a frame, for people. Plain data, no DDS.
#ifndef WIREPOSE_PUBLISH_IMAGE_REPORT_H_
#define WIREPOSE_PUBLISH_IMAGE_REPORT_H_

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>

#include "base/image_view.h"
#include "capacities.h"

namespace wirepose {

// The raw left image, 8 bit grey, rows back to back.
struct ImageReport {
  // Leaves the pixels alone: large memory that nobody may ever ask for is not touched.
  ImageReport() {}  // NOLINT(modernize-use-equals-default)

  std::chrono::nanoseconds stamp{0};
  int width = 0, height = 0;
  std::array<std::uint8_t, kMaxPixels> pixels;
};

// Copies an image of at most kMaxPixels. O(pixels).
inline void FillImage(const ImageView& image, ImageReport& report) {
  report.width = image.width;
  report.height = image.height;
  const auto width = static_cast<std::size_t>(image.width);
  for (int y = 0; y < image.height; ++y) {
    std::memcpy(report.pixels.data() + static_cast<std::size_t>(y) * width, image.row(y), width);
  }
}

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_IMAGE_REPORT_H_
