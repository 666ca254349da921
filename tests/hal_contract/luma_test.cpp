#include "hal/libcamera/luma.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

namespace wirepose::hal {
namespace {

// Luma of a pixel of the test pictures.
std::uint8_t Grey(int x, int y) { return static_cast<std::uint8_t>(7 * x + 31 * y); }

// A buffer of `width` x `height` pixels, rows padded by `padding` bytes, chroma 128.
std::vector<std::uint8_t> Buffer(LumaLayout layout, int width, int height, int padding) {
  const int step = layout == LumaLayout::kPlane ? 1 : 2;
  const int stride = step * width + padding;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(stride * height), 128);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      bytes[static_cast<std::size_t>(y * stride + x * step + (layout == LumaLayout::kUyvy ? 1 : 0))] = Grey(x, y);
    }
  }
  return bytes;
}

LumaSource Source(const std::vector<std::uint8_t>& bytes, LumaLayout layout, int width, int height) {
  return {bytes.data(), bytes.size(), width, height, static_cast<int>(bytes.size()) / height, layout};
}

TEST(Luma, FormatsByName) {
  for (const char* name : {"R8", "NV12", "NV21", "YUV420", "YVU420"}) EXPECT_EQ(LumaLayoutOf(name), LumaLayout::kPlane);
  EXPECT_EQ(LumaLayoutOf("YUYV"), LumaLayout::kYuyv);
  EXPECT_EQ(LumaLayoutOf("UYVY"), LumaLayout::kUyvy);
  for (const char* name : {"", "MJPEG", "RGB888", "R10", "SRGGB8"}) EXPECT_EQ(LumaLayoutOf(name), std::nullopt) << name;
}

class LumaLayouts : public ::testing::TestWithParam<LumaLayout> {};

TEST_P(LumaLayouts, CopiesBothHalvesOfASideBySidePicture) {
  const auto bytes = Buffer(GetParam(), 20, 6, 8);
  const LumaSource source = Source(bytes, GetParam(), 20, 6);
  ASSERT_TRUE(IsComplete(source));
  for (const int x0 : {0, 10}) {
    std::vector<std::uint8_t> pixels(60, 0);
    CopyLuma(source, x0, {pixels.data(), 10, 6, 10});
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 10; ++x) ASSERT_EQ(pixels[static_cast<std::size_t>(10 * y + x)], Grey(x0 + x, y));
    }
  }
}

TEST_P(LumaLayouts, ATransferCutShortIsNotComplete) {
  const auto bytes = Buffer(GetParam(), 20, 6, 8);
  LumaSource source = Source(bytes, GetParam(), 20, 6);
  source.bytes = bytes.size() - 8;  // the last row's padding need not come
  EXPECT_TRUE(IsComplete(source));
  source.bytes -= 1;
  EXPECT_FALSE(IsComplete(source));
  source.bytes = 0;
  EXPECT_FALSE(IsComplete(source));
  EXPECT_FALSE(IsComplete({}));
}

INSTANTIATE_TEST_SUITE_P(All, LumaLayouts, ::testing::Values(LumaLayout::kPlane, LumaLayout::kYuyv, LumaLayout::kUyvy));

TEST(Luma, PlanesAreUsedInPlace) {
  const auto bytes = Buffer(LumaLayout::kPlane, 20, 6, 12);
  const ImageView right = LumaInPlace(Source(bytes, LumaLayout::kPlane, 20, 6), 10, 10);
  EXPECT_EQ(right.data, bytes.data() + 10);
  EXPECT_EQ(right.stride, 32);
  EXPECT_EQ(right.row(5)[9], Grey(19, 5));
}

// --- Formats as cameras lay them out
// ----------------------------------------------------------------------------------

constexpr int kWide = 40, kHigh = 12;

// A whole frame in libcamera's format of that name, luma by Grey, chroma by something else, rows padded.
struct Frame {
  std::vector<std::uint8_t> bytes;  // luma plane first; the chroma planes follow it
  LumaSource source;
};

Frame MakeFrame(const std::string& format, int padding) {
  const LumaLayout layout = *LumaLayoutOf(format);
  const int step = layout == LumaLayout::kPlane ? 1 : 2, stride = step * kWide + padding;
  const auto luma = static_cast<std::size_t>(stride * kHigh);
  // NV12, NV21: one plane of pairs at half the height; YUV420, YVU420: two planes of half the width and height.
  const std::size_t chroma = format == "R8" || step == 2 ? 0 : luma / 2;
  Frame frame;
  for (std::size_t i = 0; i < luma + chroma; ++i) frame.bytes.push_back(static_cast<std::uint8_t>(201 + 3 * i));
  const bool luma_second = format == "UYVY" || format == "VYUY";
  for (int y = 0; y < kHigh; ++y) {
    for (int x = 0; x < kWide; ++x) {
      frame.bytes[static_cast<std::size_t>(y * stride + step * x + (luma_second ? 1 : 0))] = Grey(x, y);
    }
  }
  // What libcamera says the first plane holds.
  frame.source = {frame.bytes.data(), luma, kWide, kHigh, stride, layout};
  return frame;
}

class LumaFormats : public ::testing::TestWithParam<std::tuple<std::string, int>> {
 protected:
  static void ExpectColumns(const ImageView& image, int x0, int width) {
    ASSERT_NE(image.data, nullptr);
    ASSERT_EQ(image.width, width);
    ASSERT_EQ(image.height, kHigh);
    for (int y = 0; y < kHigh; ++y) {
      for (int x = 0; x < width; ++x) ASSERT_EQ(image(x, y), Grey(x0 + x, y)) << x << ' ' << y;
    }
  }
};

TEST_P(LumaFormats, OneEyeACamera) {
  const auto& [format, padding] = GetParam();
  const Frame frame = MakeFrame(format, padding);
  std::vector<std::uint8_t> own(kWide * kHigh, 0);
  const ImageView image = EyeImage(frame.source, 0, {own.data(), kWide, kHigh, kWide});
  ExpectColumns(image, 0, kWide);
  const bool in_place = frame.source.layout == LumaLayout::kPlane;
  EXPECT_EQ(image.data, in_place ? frame.bytes.data() : own.data()) << "copied only where it must be";
}

TEST_P(LumaFormats, BothEyesSideBySide) {
  const auto& [format, padding] = GetParam();
  const Frame frame = MakeFrame(format, padding);
  constexpr int kEye = kWide / 2;
  std::vector<std::uint8_t> left(kEye * kHigh, 0), right(kEye * kHigh, 0);
  const ImageView left_image = EyeImage(frame.source, 0, {left.data(), kEye, kHigh, kEye});
  const ImageView right_image = EyeImage(frame.source, kEye, {right.data(), kEye, kHigh, kEye});
  ExpectColumns(left_image, 0, kEye);
  ExpectColumns(right_image, kEye, kEye);
  if (frame.source.layout == LumaLayout::kPlane) {
    EXPECT_EQ(right_image.stride, frame.source.stride);
  }
}

// A frame that is short, narrow or low is refused, never read beyond its end.
TEST_P(LumaFormats, RefusesWhatDoesNotHoldTheEye) {
  const auto& [format, padding] = GetParam();
  const Frame frame = MakeFrame(format, padding);
  std::vector<std::uint8_t> own(2 * kWide * kHigh, 7);
  const MutableImageView eye{own.data(), kWide, kHigh, kWide};
  LumaSource source = frame.source;
  source.bytes -= static_cast<std::size_t>(padding) + 1;
  EXPECT_EQ(EyeImage(source, 0, eye).data, nullptr) << "cut short";
  EXPECT_EQ(EyeImage(frame.source, 1, eye).data, nullptr) << "beyond the right border";
  EXPECT_EQ(EyeImage(frame.source, -1, eye).data, nullptr);
  EXPECT_EQ(EyeImage(frame.source, 0, {own.data(), kWide, kHigh + 1, kWide}).data, nullptr) << "too low";
  source = frame.source;
  source.stride = kWide - 1;
  EXPECT_EQ(EyeImage(source, 0, eye).data, nullptr) << "rows that overlap";
  EXPECT_EQ(EyeImage({}, 0, eye).data, nullptr);
  EXPECT_TRUE(std::all_of(own.begin(), own.end(), [](std::uint8_t v) { return v == 7; })) << "and nothing was written";
}

INSTANTIATE_TEST_SUITE_P(
    All, LumaFormats,
    ::testing::Combine(::testing::Values("R8", "NV12", "NV21", "YUV420", "YVU420", "YUYV", "YVYU", "UYVY", "VYUY"),
                       ::testing::Values(0, 24)),
    [](const auto& one) { return std::get<0>(one.param) + (std::get<1>(one.param) == 0 ? "" : "_padded"); });

// --- Choice
// -----------------------------------------------------------------------------------------------------------

TEST(PixelFormatChoice, TakesTheCheapestThatIsOffered) {
  using Offered = std::vector<std::string>;
  const struct {
    Offered offered;
    std::string chosen;
  } cases[] = {{{"MJPEG", "YUYV", "NV12", "R8"}, "R8"},
               {{"YUYV", "YUV420", "NV12"}, "NV12"},
               {{"UYVY", "YUYV", "YUV420"}, "YUV420"},
               {{"UYVY", "YUYV"}, "YUYV"},
               {{"MJPEG", "UYVY"}, "UYVY"}};
  for (const auto& [offered, chosen] : cases) {
    const auto format = ChoosePixelFormat("", offered);
    ASSERT_TRUE(format) << format.error();
    EXPECT_EQ(format->name, chosen);
    EXPECT_EQ(format->layout, LumaLayoutOf(chosen));
  }
  EXPECT_EQ(ChoosePixelFormat("YVU420", Offered{"R8", "YVU420"})->name, "YVU420") << "what is asked for comes first";
}

TEST(PixelFormatChoice, RefusalsNameFormatOffersAndRemedy) {
  const std::vector<std::string> offered = {"MJPEG", "SRGGB10", "NV12"}, colour = {"MJPEG", "RGB888"};
  const auto error = [](std::string_view wanted, const std::vector<std::string>& from) {
    const auto format = ChoosePixelFormat(wanted, from);
    EXPECT_FALSE(format) << wanted;
    return format ? std::string() : format.error();
  };
  for (const char* const bad : {"MJPEG", "SRGGB10", "R10", "nv12", "NV12 "}) {
    const std::string text = error(bad, offered);
    EXPECT_NE(text.find(std::string("'").append(bad).append("'")), std::string::npos) << text;
    EXPECT_NE(text.find("it offers MJPEG SRGGB10 NV12"), std::string::npos) << text;
    EXPECT_NE(text.find("set pixel_format"), std::string::npos) << text;
  }
  EXPECT_NE(error("YUYV", offered).find("does not offer 'YUYV', but MJPEG SRGGB10 NV12"), std::string::npos);
  EXPECT_NE(error("", colour).find("it offers MJPEG RGB888; choose another camera"), std::string::npos);
  EXPECT_NE(error("", {}).find("no format"), std::string::npos);
}

}  // namespace
}  // namespace wirepose::hal
