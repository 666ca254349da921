// Both eyes together: determinism, and that the right image is where depth and calibration say.
#include <gtest/gtest.h>

#include <cmath>

#include "opencv_projection.h"
#include "sim/lens.h"
#include "sim/scenario_video.h"
#include "test_scenes.h"

namespace wirepose::sim {
namespace {

ScenarioSpec SmallSpec(std::uint64_t seed) {
  ScenarioSpec spec;
  spec.seed = seed;
  spec.camera.calibration = test::SmallCalibration();
  spec.path.shake_deg = {0.2, 0.2};
  return spec;
}

TEST(Stereo, SameSeedSameBytesOnAnyNumberOfThreads) {
  const auto one = ScenarioVideo::Create(SmallSpec(5), 0, test::BoxAndBook(), 1);
  const auto three = ScenarioVideo::Create(SmallSpec(5), 0, test::BoxAndBook(), 3);
  ASSERT_TRUE(one && three);
  const StereoShot later = one->Shoot(3), first = one->Shoot(0);
  const StereoShot first_again = three->Shoot(0), later_again = three->Shoot(3);  // other order
  EXPECT_EQ(first.left.pixels, first_again.left.pixels);
  EXPECT_EQ(first.right.pixels, first_again.right.pixels);
  EXPECT_EQ(first.truth.depth_m, first_again.truth.depth_m);
  EXPECT_EQ(later.left.pixels, later_again.left.pixels);
  EXPECT_NE(first.left.pixels, later.left.pixels);
}

TEST(Stereo, OtherSeedOtherBytes) {
  const auto a = ScenarioVideo::Create(SmallSpec(5), 0, test::BoxAndBook());
  const auto b = ScenarioVideo::Create(SmallSpec(6), 0, test::BoxAndBook());
  const auto second_scene = ScenarioVideo::Create(SmallSpec(5), 1, test::BoxAndBook());
  ASSERT_TRUE(a && b && second_scene);
  EXPECT_NE(a->Shoot(0).left.pixels, b->Shoot(0).left.pixels);
  EXPECT_EQ(second_scene->Shoot(0).left.pixels, b->Shoot(0).left.pixels) << "scenes count the seed up";
}

TEST(Stereo, RefusesOptionsOutOfRange) {
  ScenarioSpec spec = SmallSpec(1);
  spec.samples = 7;
  EXPECT_FALSE(ScenarioVideo::Create(spec, 0, test::BoxAndBook()));
  spec.samples = -4;
  EXPECT_FALSE(ScenarioVideo::Create(spec, 0, test::BoxAndBook()));
  spec = SmallSpec(1);
  spec.rate_hz = 0;
  EXPECT_FALSE(ScenarioVideo::Create(spec, 0, test::BoxAndBook()));
  EXPECT_FALSE(ScenarioVideo::Create(SmallSpec(1), 0, test::BoxAndBook(), 0));
  EXPECT_FALSE(ScenarioVideo::Create(SmallSpec(1), 0, {}));
}

// A slanted plane with a strong texture: every left pixel's light must be found in the right image
// at the place that its true depth, the calibration and OpenCV's projection give, and nowhere half
// a pixel off.
TEST(Stereo, RightImageIsWhereDepthAndCalibrationSay) {
  const StereoCalibration calibration = test::SmallCalibration(0.5);
  Scene scene;
  scene.meshes = {MakeBox({4.0F, 4.0F, 0.01F})};
  Instance plane = test::Glowing(
      0, {Eigen::AngleAxisd(0.5, Vector3d(1, 1, 0).normalized()).toRotationMatrix(), Vector3d(0, 0, 1.1)});
  plane.material.texture = Texture::kStone;
  plane.material.scale_m = 0.2F;
  plane.material.albedo = 0.5F;
  scene.instances = {plane};
  scene.ambient_up = scene.ambient_down = 1;
  StereoRig rig;
  rig.calibration = calibration;
  const Renderer renderer(scene);
  const RadianceImage left = renderer.Render(LeftCamera(rig), {});
  const RadianceImage right = renderer.Render(RightCamera(rig), {.seed = 2});
  const Truth truth = FindTruth(renderer, LeftCamera(rig), 2);
  const Lens lens(calibration.left);

  const auto mismatch = [&](const Vector2d& shift) {
    double sum = 0;
    int count = 0;
    for (int y = 0; y < calibration.height; y += 2) {
      for (int x = 0; x < calibration.width; x += 2) {
        const double z = double{truth.depth_m[static_cast<std::size_t>(y * calibration.width + x)]};
        const Vector2d xy = lens.RayOf(Vector2d(x, y))->xy;
        const Vector3d p = calibration.T_right_left * (z * Vector3d(xy.x(), xy.y(), 1));
        const Vector2d q = test::ProjectWithOpenCv(calibration.right, {p})[0] + shift;
        const int u = static_cast<int>(std::floor(q.x())), v = static_cast<int>(std::floor(q.y()));
        if (u < 0 || v < 0 || u + 1 >= calibration.width || v + 1 >= calibration.height) continue;
        const double a = q.x() - u, b = q.y() - v;
        const double seen = (1 - b) * ((1 - a) * double{right(u, v)} + a * double{right(u + 1, v)}) +
                            b * ((1 - a) * double{right(u, v + 1)} + a * double{right(u + 1, v + 1)});
        sum += std::abs(seen - double{left(x, y)});
        ++count;
      }
    }
    EXPECT_GT(count, 10000);
    return sum / count;
  };
  const double exact = mismatch({0, 0});
  EXPECT_LT(exact, 0.01);
  for (const Vector2d& shift : {Vector2d(0.5, 0), Vector2d(-0.5, 0), Vector2d(0, 0.5), Vector2d(0, -0.5)}) {
    EXPECT_GT(mismatch(shift), 1.1 * exact);
  }
}

TEST(Stereo, DepthImageHoldsTenthsOfMillimetres) {
  Truth truth;
  truth.width = 4;
  truth.height = 1;
  truth.depth_m = {0, 1.00004F, 6.5535F, 6.6F};
  EXPECT_EQ(ToDepthImage(truth).pixels, (std::vector<std::uint16_t>{0, 10000, 65535, 0}));
}

}  // namespace
}  // namespace wirepose::sim
