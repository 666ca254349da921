#include "hal/libcamera/luma.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace wirepose::hal
