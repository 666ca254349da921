#include "hal/libcamera/luma.h"

#include <algorithm>
#include <cstring>
#include <iterator>

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

Result<PixelFormat, std::string> ChoosePixelFormat(std::string_view wanted, std::span<const std::string> offered) {
  static constexpr std::string_view kPreferred[] = {"R8", "NV12", "YUV420", "YUYV", "UYVY"};
  const auto offers = [&](std::string_view name) {
    return std::find(offered.begin(), offered.end(), name) != offered.end();
  };
  std::string list;
  for (const std::string& name : offered) list.append(" ").append(name);
  if (list.empty()) list = " no format";
  if (wanted.empty()) {
    const auto* const found = std::find_if(std::begin(kPreferred), std::end(kPreferred), offers);
    if (found == std::end(kPreferred)) {
      return unexpected("has none of R8, NV12, YUV420, YUYV, UYVY; it offers" + list + "; choose another camera");
    }
    wanted = *found;
  }
  const std::string name(wanted);
  const std::optional<LumaLayout> layout = LumaLayoutOf(name);
  if (!layout) {
    return unexpected("has no 8 bit luma in '" + name + "'; it offers" + list +
                      "; set pixel_format to R8, NV12, NV21, YUV420, YVU420, YUYV, YVYU, UYVY or VYUY");
  }
  if (!offers(name)) {
    return unexpected("does not offer '" + name + "', but" + list + "; change pixel_format or choose another camera");
  }
  return PixelFormat{name, *layout};
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

ImageView EyeImage(const LumaSource& source, int x, const MutableImageView& out) {
  if (!IsComplete(source) || x < 0 || x + out.width > source.width || out.height != source.height) return {};
  if (source.layout == LumaLayout::kPlane) return LumaInPlace(source, x, out.width);
  CopyLuma(source, x, out);
  return out;
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
