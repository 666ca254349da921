// The grey image inside a camera's buffer.
#ifndef WIREPOSE_HAL_LIBCAMERA_LUMA_H_
#define WIREPOSE_HAL_LIBCAMERA_LUMA_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "base/image_view.h"

namespace wirepose::hal {

// Where luma lies in a row of pixels.
enum class LumaLayout : std::uint8_t {
  kPlane,  // a plane of its own, first in the buffer: R8, NV12, NV21, YUV420, YVU420: usable in place
  kYuyv,   // every second byte, from the first: YUYV, YVYU
  kUyvy,   // every second byte, from the second: UYVY, VYUY
};

// By the name that libcamera gives a pixel format; nothing for one without 8 bit luma.
[[nodiscard]] std::optional<LumaLayout> LumaLayoutOf(std::string_view pixel_format);

// A buffer as the camera filled it.
struct LumaSource {
  const std::uint8_t* data = nullptr;
  std::size_t bytes = 0;                  // that the camera wrote
  int width = 0, height = 0, stride = 0;  // pixels, rows, bytes
  LumaLayout layout = LumaLayout::kPlane;
};

// True when the buffer holds every row: false for a transfer that was cut short.
[[nodiscard]] bool IsComplete(const LumaSource& source);

// The luma of columns [x, x + width) without copying. Requires kPlane and IsComplete.
[[nodiscard]] ImageView LumaInPlace(const LumaSource& source, int x, int width);

// Copies the luma of as many columns as `out` has, from column x on. Requires IsComplete. O(pixels).
void CopyLuma(const LumaSource& source, int x, const MutableImageView& out);

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_LIBCAMERA_LUMA_H_
