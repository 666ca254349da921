// The grey image inside a camera's buffer.
#ifndef WIREPOSE_HAL_LIBCAMERA_LUMA_H_
#define WIREPOSE_HAL_LIBCAMERA_LUMA_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/image_view.h"
#include "base/result.h"

namespace wirepose::hal {

// Where luma lies in a row of pixels.
enum class LumaLayout : std::uint8_t {
  kPlane,  // a plane of its own, first in the buffer: R8, NV12, NV21, YUV420, YVU420: usable in place
  kYuyv,   // every second byte, from the first: YUYV, YVYU
  kUyvy,   // every second byte, from the second: UYVY, VYUY
};

// By the name that libcamera gives a pixel format; nothing for one without 8 bit luma.
[[nodiscard]] std::optional<LumaLayout> LumaLayoutOf(std::string_view pixel_format);

struct PixelFormat {
  std::string name;  // libcamera's
  LumaLayout layout = LumaLayout::kPlane;
};

// The format `wanted`, or, when that is empty, the first of R8, NV12, YUV420, YUYV, UYVY that is among the `offered`
// ones. The error says what is offered and what to do; it begins with a verb: "has no ...".
[[nodiscard]] Result<PixelFormat, std::string> ChoosePixelFormat(std::string_view wanted,
                                                                 std::span<const std::string> offered);

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

// The image of one eye: `out.width` columns from column `x` on. In place where luma has a plane of its own, else copied
// into `out`. Empty (null data) when the buffer is not complete or does not reach that far.
[[nodiscard]] ImageView EyeImage(const LumaSource& source, int x, const MutableImageView& out);

// Copies the luma of as many columns as `out` has, from column x on. Requires IsComplete. O(pixels).
void CopyLuma(const LumaSource& source, int x, const MutableImageView& out);

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_LIBCAMERA_LUMA_H_
