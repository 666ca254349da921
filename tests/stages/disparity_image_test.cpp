// Depth images become disparities: exactly, without what lies on jumps, through the lens.
#include "stages/disparity_image.h"

#include <gtest/gtest.h>

#include "depth_scene.h"

namespace wirepose {
namespace {

using testing::DepthCamera;
using testing::DepthImage;
using testing::DisparitiesOf;
using testing::PaintDepth;
using testing::Random;

TEST(DisparityImage, IsTheDisparityOfEveryDepth) {
  const RectifiedCamera camera = DepthCamera(160, 120, 300);
  Random random(1);
  // A slanted plane: no jumps anywhere.
  const Vector3d n = Vector3d(0.3, -0.2, 1).normalized();
  const auto z = [&](int x, int y) { return testing::PlaneDepth(camera, n, 0.8, x, y); };
  const auto image = DisparitiesOf(camera, PaintDepth(160, 120, z));
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const double expected = camera.DisparityOfDepth(z(x, y));
      // Half a unit of the depth image and half a unit of disparity.
      EXPECT_NEAR(static_cast<double>(image->At(x, y)), expected, 0.51 / 64 + 0.5 * expected * 1e-4 / z(x, y));
    }
  }
  const auto map = std::make_unique<DisparityMap>();
  ShrinkDisparity(*image, *map);
  EXPECT_EQ(map->width, 80);
  EXPECT_EQ(map->height, 60);
  for (int y = 0; y < 120; y += 2) {
    for (int x = 0; x < 160; x += 2) {
      const double middle = camera.DisparityOfDepth(testing::PlaneDepth(camera, n, 0.8, x + 0.5, y + 0.5));
      EXPECT_NEAR(static_cast<double>(map->At(x, y)), middle, 0.5 / 8 + 0.03);
    }
  }
}

TEST(DisparityImage, HolesStayUnknownAndNothingElse) {
  const RectifiedCamera camera = DepthCamera(100, 80, 300);
  const auto hole = [](int x, int y) { return x > 20 && x < 40 && y > 10 && y < 30; };
  const auto image = DisparitiesOf(camera, PaintDepth(100, 80, [&](int x, int y) { return hole(x, y) ? 0 : 0.7; }));
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 100; ++x) EXPECT_EQ(image->At(x, y) == 0, hole(x, y)) << x << ' ' << y;
  }
}

// Near object, far wall, and between them a pixel that a sensor made up.
TEST(DisparityImage, PixelsOnJumpsAreUnknown) {
  const RectifiedCamera camera = DepthCamera(100, 80, 300);
  const auto image = DisparitiesOf(camera, PaintDepth(100, 80, [](int x, int) {
                                     return x < 50 ? 0.6 : x == 50 ? 0.83 : 1.2;
                                   }));
  for (int y = 0; y < 80; ++y) {
    EXPECT_NEAR(static_cast<double>(image->At(48, y)), camera.DisparityOfDepth(0.6), 0.02);
    EXPECT_EQ(image->At(49, y), 0);
    EXPECT_EQ(image->At(50, y), 0);
    EXPECT_EQ(image->At(51, y), 0);
    EXPECT_NEAR(static_cast<double>(image->At(52, y)), camera.DisparityOfDepth(1.2), 0.02);
  }
}

TEST(DisparityImage, TooNearIsUnknownInsteadOfWrapped) {
  const RectifiedCamera camera = DepthCamera(64, 64, 600);  // f*B = 60: 1024 px are 5.9 cm
  for (const double z : {0.0001, 0.01, 0.058}) {
    const auto image = DisparitiesOf(camera, PaintDepth(64, 64, [z](int, int) { return z; }));
    EXPECT_EQ(image->At(30, 30), 0) << z;
  }
  const auto image = DisparitiesOf(camera, PaintDepth(64, 64, [](int, int) { return 0.06; }));
  EXPECT_NEAR(static_cast<double>(image->At(30, 30)), 1000, 1);
}

TEST(Undistortion, LeavesAnImageWithoutDistortionAsItIs) {
  const DepthCalibration calibration{{607.2, 607.2, 321.4, 241.9}, 640, 480};
  const auto out = std::make_unique<Rectification>();
  ASSERT_TRUE(ComputeUndistortion(calibration, *out));
  EXPECT_FALSE(out->camera.has_right_image);
  EXPECT_NEAR(out->camera.cx, 321.4, 1e-9);
  EXPECT_NEAR(out->camera.cy, 241.9, 1e-9);
  EXPECT_EQ(out->T_rectified_raw.R, Matrix3d::Identity());
  Random random(2);
  const auto noise = testing::Paint(640, 480, [&](int, int) { return random.Uniform(0, 255); });
  testing::GrayImage same = noise;
  std::fill(same.pixels.begin(), same.pixels.end(), 7);
  RectifyImage(noise.view(), out->left, same.mutable_view());
  EXPECT_EQ(same.pixels, noise.pixels);
}

// Points through the lens and back: where the raw camera sees a point, the rectified one sees it after resampling.
TEST(Undistortion, RemovesTheLensFromImageAndDepth) {
  DepthCalibration calibration{{300, 303, 158, 122, -0.12, 0.03, 0.001, -0.0005, 0}, 320, 240};
  const auto out = std::make_unique<Rectification>();
  ASSERT_TRUE(ComputeUndistortion(calibration, *out));
  const RectifiedCamera& camera = out->camera;
  // Depth that tells its own raw column and row.
  DepthImage raw{320, 240, {}};
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) raw.pixels.push_back(static_cast<std::uint16_t>(1 + x + 200 * y));
  }
  std::vector<std::uint16_t> rectified(kMaxPixels);
  RectifyDepth(raw.view(), out->left, 320, 240, rectified.data());
  int seen = 0;
  for (int y = 5; y < 235; y += 7) {
    for (int x = 5; x < 315; x += 7) {
      const std::uint16_t value = rectified[static_cast<std::size_t>(y * kMaxImageWidth + x)];
      if (value == 0) continue;
      const Eigen::Vector2d p =
          DistortAndProject(calibration.camera, (x - camera.cx) / camera.f, (y - camera.cy) / camera.f);
      const int column = static_cast<int>(std::floor(p.x() + 0.5)), row = static_cast<int>(std::floor(p.y() + 0.5));
      bool near = false;  // rounding of the map may choose a neighbour
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) near = near || value == 1 + column + dx + 200 * (row + dy);
      }
      EXPECT_TRUE(near) << x << ' ' << y;
      ++seen;
    }
  }
  EXPECT_GT(seen, 800);
}

TEST(Undistortion, RefusesCamerasThatAreNone) {
  const auto out = std::make_unique<Rectification>();
  EXPECT_FALSE(ComputeUndistortion({{0, 300, 160, 120}, 320, 240}, *out));
  EXPECT_FALSE(ComputeUndistortion({{300, -1, 160, 120}, 320, 240}, *out));
  EXPECT_FALSE(ComputeUndistortion({{300, 300, std::nan(""), 120}, 320, 240}, *out));
}

}  // namespace
}  // namespace wirepose
