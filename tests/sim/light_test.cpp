// The simulator as a ruler: edges, light, blur and shading against what can be computed by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "test_scenes.h"

namespace wirepose::sim {
namespace {

constexpr int kImageSide = 96;  // px

Camera Pinhole(double psf_sigma_px = 0.5) {
  const double c = 0.5 * (kImageSide - 1);
  return {{100, 100, c, c}, kImageSide, kImageSide, Pose{}, psf_sigma_px};
}

// A bright half plane over a dark one, 1 m away: its edge passes `offset_px` from the image's
// middle and is turned by `angle_rad`.
Scene Step(double angle_rad, double offset_px) {
  Scene scene;
  scene.meshes = {MakeBox({6, 6, 1e-4F}), MakeBox({8, 8, 0.1F})};
  const Matrix3d turn = Eigen::AngleAxisd(angle_rad, Vector3d::UnitZ()).toRotationMatrix();
  Instance bright = test::Glowing(0, {turn, turn * Vector3d(3 + offset_px / 100, 0, 0) + Vector3d(0, 0, 1)});
  Instance dark = test::Glowing(1, {Matrix3d::Identity(), Vector3d(0, 0, 1.3)});
  bright.material.albedo = 0.8F;
  dark.material.albedo = 0.2F;
  scene.instances = {bright, dark};
  scene.ambient_up = scene.ambient_down = 1;
  return scene;
}

double Bilinear(const dataset::GrayImage& image, const Eigen::Vector2d& p) {
  const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
  const double u = p.x() - x, v = p.y() - y;
  const auto at = [&](int i, int j) {
    return double{static_cast<double>(image.pixels[static_cast<std::size_t>(j * image.width + i)])};
  };
  return (1 - v) * ((1 - u) * at(x, y) + u * at(x + 1, y)) + v * ((1 - u) * at(x, y + 1) + u * at(x + 1, y + 1));
}

// Where the step is along the normal at `along_px`: the place whose ideal step has the profile's
// integral, which interpolation between pixels keeps.
double EdgeAt(const dataset::GrayImage& image, const Eigen::Vector2d& normal, double along_px) {
  const Eigen::Vector2d middle =
      Eigen::Vector2d::Constant(0.5 * (kImageSide - 1)) + along_px * Eigen::Vector2d(-normal.y(), normal.x());
  constexpr int kSteps = 40;
  constexpr double kStep = 0.1;  // px; the step within 4 px, its two levels from 4 to 8 px off
  double low = 0, high = 0, sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double inner = (i + 0.5) * kStep, outer = inner + kSteps * kStep;
    low += Bilinear(image, middle - outer * normal) / kSteps;
    high += Bilinear(image, middle + outer * normal) / kSteps;
    sum += kStep * (Bilinear(image, middle + inner * normal) + Bilinear(image, middle - inner * normal));
  }
  return kSteps * kStep - (sum - 2 * kSteps * kStep * low) / (high - low);
}

TEST(EdgePosition, IsWithinThreeHundredthsOfAPixelInAllDirections) {
  Random random(71);
  double sum = 0;
  int count = 0;
  for (int degrees = 0; degrees < 360; degrees += 15) {
    const double angle = degrees * kDegree, offset = random.Uniform(-0.5, 0.5);
    const Renderer renderer(Step(angle, offset));
    const RadianceImage light = renderer.Render(Pinhole(), {.seed = 100U + static_cast<std::uint64_t>(degrees)});
    const dataset::GrayImage image = Expose(light, 1, Sensor{}, 7);
    double mean = 0;
    int profiles = 0;
    for (double along = -30; along <= 30; along += 1.3, ++profiles) {
      mean += EdgeAt(image, {std::cos(angle), std::sin(angle)}, along) - offset;
    }
    EXPECT_LT(std::abs(mean / profiles), 0.03) << degrees << " degrees, offset " << offset;
    sum += std::abs(mean / profiles);
    ++count;
  }
  printf("edges off by %.4f px in the mean over %d directions\n", sum / count, count);
}

// A camera that moves along x by d pixels while it exposes adds d^2 / 12 to the edge's variance.
TEST(MotionBlur, WidensEdgesByThePathLength) {
  const Renderer renderer(Step(0, 0));
  double variances[2] = {};
  for (int i = 0; i < 2; ++i) {
    Camera camera = Pinhole();
    camera.exposure_s = 0.02;
    camera.velocity = Vector3d(i == 0 ? 0 : 2.0, 0, 0);  // 2 m/s * 20 ms * 100 px = 4 px
    const RadianceImage image = renderer.Render(camera, {.samples_per_side = 6});
    double sum = 0, mean = 0, square = 0;
    for (int x = 30; x < 65; ++x) {
      double slope = 0;
      for (int y = 20; y < 70; ++y) slope += double{image(x + 1, y)} - double{image(x, y)};
      sum += slope;
      mean += slope * (x + 0.5);
      square += slope * (x + 0.5) * (x + 0.5);
    }
    mean /= sum;
    EXPECT_NEAR(mean, 47.5, 0.05) << "the capture time is the middle of the exposure";
    variances[i] = square / sum - mean * mean;
  }
  EXPECT_NEAR(variances[1] - variances[0], 16.0 / 12, 0.08);
}

TEST(MotionBlur, TurningIsBlurToo) {
  const Renderer renderer(Step(0, 0));
  Camera camera = Pinhole(), still = Pinhole();
  camera.exposure_s = 0.02;
  camera.rotation_rate = Vector3d(0, 2, 0);  // 2 rad/s about y: 4 px
  const RadianceImage moved = renderer.Render(camera, {}), sharp = renderer.Render(still, {});
  const auto rise = [](const RadianceImage& image) { return double{image(49, 48)} - double{image(46, 48)}; };
  EXPECT_LT(rise(moved), 0.8 * rise(sharp));
}

TEST(Vignetting, FollowsTheSquareOfTheDistance) {
  Scene scene;
  scene.background = 0.5F;
  Camera camera = Pinhole();
  camera.vignetting = 0.3;
  const RadianceImage image = Renderer(scene).Render(camera, {});
  EXPECT_NEAR(double{image(47, 47)}, 0.5, 1e-3);
  EXPECT_NEAR(double{image(0, 0)}, 0.5 * 0.7, 5e-3);
  EXPECT_NEAR(double{image(0, 47)}, 0.5 * 0.85, 5e-3);
}

// In a world of even light every white matt surface is as bright as the world: no light is made or
// lost.
TEST(IndirectLight, WhiteFurnace) {
  Scene scene;
  Pose T{Eigen::AngleAxisd(0.7, Vector3d(1, 2, 0.5).normalized()).toRotationMatrix(), Vector3d(0, 0, 0.8)};
  scene.meshes = {MakeBox({0.2F, 0.2F, 0.2F})};
  scene.instances = {test::Glowing(0, T)};
  scene.background = 0.6F;
  scene.ambient_up = scene.ambient_down = 0.6F;
  const RadianceImage image = Renderer(scene).Render(Pinhole(), {.is_indirect = true});
  for (const float pixel : image.pixels) ASSERT_NEAR(double{pixel}, 0.6, 1e-4);
}

// One wall lights the other: the form factor of a square seen from a point on its axis is known
// (Howell B-4 doubled twice).
TEST(IndirectLight, AgreesWithTheFormFactorOfASquare) {
  Scene scene;
  scene.meshes = {MakeBox({0.002F, 0.002F, 0.002F}), MakeBox({2, 2, 0.02F})};
  Instance speck = test::Glowing(0, {Matrix3d::Identity(), Vector3d(0, 0, 0.1)});
  Instance wall = test::Glowing(1, {Matrix3d::Identity(), Vector3d(0, 0, -0.91)});  // 1 m from the speck's face
  wall.material.albedo = 0.5F;
  scene.instances = {speck, wall};
  scene.ambient_up = scene.ambient_down = 1;  // the wall's own light
  Camera camera = Pinhole(0);
  const RadianceImage image = Renderer(scene).Render(camera, {.is_indirect = true});
  // Half side a = 1 at distance 1: F = 4 * (1/2pi) * 2 * x/sqrt(1+x^2) * atan(x/sqrt(1+x^2)), x = 1.
  const double x = 1 / std::sqrt(2.0), form = 4 / (2 * std::numbers::pi) * 2 * x * std::atan(x);
  double mean = 0;
  int count = 0;
  for (int j = 47; j < 49; ++j) {
    for (int i = 47; i < 49; ++i, ++count) mean += double{image(i, j)};
  }
  EXPECT_NEAR(mean / count, 0.5 * form, 0.05 * form);
}

// A mirror shows the world behind the camera, darker by its reflectance.
TEST(Gloss, MirrorsWhatIsThere) {
  Scene scene;
  scene.meshes = {MakeBox({4, 4, 0.1F}), MakeBox({1, 8, 0.1F})};
  Instance mirror = test::Glowing(0, {Matrix3d::Identity(), Vector3d(0, 0, 1.05)});
  mirror.material.albedo = 0;
  mirror.material.gloss = 0.3F;
  mirror.material.roughness = 0;
  Instance lamp = test::Glowing(1, {Matrix3d::Identity(), Vector3d(0.5, 0, -1.05)});  // x from 0 on
  scene.instances = {mirror, lamp};
  scene.ambient_up = scene.ambient_down = 1;
  const RadianceImage image = Renderer(scene).Render(Pinhole(), {});
  EXPECT_NEAR(double{image(52, 47)}, 0.3, 0.01);
  EXPECT_NEAR(double{image(43, 47)}, 0, 0.01);
}

// The mean over many samples of one area light against the integral over its face.
TEST(DirectLight, AgreesWithTheIntegralOverTheLight) {
  Scene scene;
  scene.meshes = {MakeBox({6, 6, 0.1F})};
  Instance floor = test::Glowing(0, {Matrix3d::Identity(), Vector3d(0, 0, 1.05)});
  scene.instances = {floor};
  scene.ambient_up = scene.ambient_down = 0;
  // Behind the camera, shining forwards; another one beside it, so that lights are chosen among.
  scene.lights = {{{0.6F, 0.2F, -0.5F}, {0.3F, 0, 0}, {0, 0.4F, 0}, 2},
                  {{-1, 0, 0.2F}, {0, 0.2F, 0}, {-0.1F, 0, 0}, 1}};
  const RadianceImage image = Renderer(scene).Render(Pinhole(), {.samples_per_side = 6});
  double expected = 0;
  for (const AreaLight& light : scene.lights) {
    constexpr int kCells = 60;
    const Vector3 shine = light.half_u.cross(light.half_v).normalized();
    for (int i = 0; i < kCells * kCells; ++i) {
      const float u = 2 * (static_cast<float>(i % kCells) + 0.5F) / kCells - 1,
                  v = 2 * (static_cast<float>(i / kCells) + 0.5F) / kCells - 1;
      const Vector3 to = light.centre + u * light.half_u + v * light.half_v - Vector3(0, 0, 1);
      const double r2 = double{to.squaredNorm()};
      expected += double{light.intensity} * double{-to.z()} * std::max(0.0, -double{shine.dot(to)}) / (r2 * r2) /
                  (kCells * kCells);
    }
  }
  double mean = 0;
  for (int y = 46; y < 50; ++y) {
    for (int x = 46; x < 50; ++x) mean += double{image(x, y)} / 16;
  }
  EXPECT_NEAR(mean / expected, 1, 0.01);
}

}  // namespace
}  // namespace wirepose::sim
