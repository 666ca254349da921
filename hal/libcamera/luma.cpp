#include "hal/libcamera/luma.h"

#include <cstring>

#include "base/check.h"

namespace wirepose::hal {
namespace {

int BytesPerPixel(LumaLayout layout) { return layout == LumaLayout::kPlane ? 1 : 2; }

}  // namespace

std::optional<LumaLayout> LumaLayoutOf(std::string_view pixel_format) {
  for (const std::string_view name : {"R8", "NV12", "NV21", "YUV420", "YVU420"}) {
    if (pixel_format == name) return LumaLayout::kPlane;
  }
  if (pixel_format == "YUYV" || pixel_format == "YVYU") return LumaLayout::kYuyv;
  if (pixel_format == "UYVY" || pixel_format == "VYUY") return LumaLayout::kUyvy;
  return std::nullopt;
}

bool IsComplete(const LumaSource& source) {
  if (source.data == nullptr || source.width <= 0 || source.height <= 0) return false;
  const auto row = static_cast<std::size_t>(source.width) * static_cast<std::size_t>(BytesPerPixel(source.layout));
  const auto stride = static_cast<std::size_t>(source.stride);
  return stride >= row && source.bytes >= stride * static_cast<std::size_t>(source.height - 1) + row;
}

ImageView LumaInPlace(const LumaSource& source, int x, int width) {
  Check(source.layout == LumaLayout::kPlane && x >= 0 && width > 0 && x + width <= source.width);
  return {source.data + x, width, source.height, source.stride};
}

void CopyLuma(const LumaSource& source, int x, const MutableImageView& out) {
  Check(x >= 0 && x + out.width <= source.width && out.height == source.height);
  const int step = BytesPerPixel(source.layout);
  const std::uint8_t* row = source.data + x * step + (source.layout == LumaLayout::kUyvy ? 1 : 0);
  for (int y = 0; y < out.height; ++y, row += source.stride) {
    std::uint8_t* to = out.data + static_cast<std::ptrdiff_t>(y) * out.stride;
    if (step == 1) {
      std::memcpy(to, row, static_cast<std::size_t>(out.width));
    } else {
      for (int i = 0; i < out.width; ++i) to[i] = row[2 * i];
    }
  }
}

}  // namespace wirepose::hal
