#include "sim/lens.h"

#include <gtest/gtest.h>

#include "opencv_projection.h"
#include "test_scenes.h"

namespace wirepose::sim {
namespace {

CameraIntrinsics AnyIntrinsics(Random& random) {
  return {random.Uniform(300, 900),      random.Uniform(300, 900),      random.Uniform(300, 340),
          random.Uniform(220, 260),      random.Uniform(-0.12, 0.05),   random.Uniform(-0.01, 0.03),
          random.Uniform(-0.001, 0.001), random.Uniform(-0.001, 0.001), random.Uniform(-0.005, 0.005)};
}

Vector2d AnyDirection(Random& random) { return {random.Uniform(-0.6, 0.6), random.Uniform(-0.5, 0.5)}; }

TEST(Lens, AgreesWithOpenCv) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const CameraIntrinsics intrinsics = AnyIntrinsics(random);
    const Vector2d xy = AnyDirection(random);
    const auto expected = test::ProjectWithOpenCv(intrinsics, {Vector3d(xy.x(), xy.y(), 1)});
    EXPECT_LT((Lens(intrinsics).PixelOf(xy) - expected[0]).norm(), 1e-9);
  }
}

TEST(Lens, RayOfInvertsPixelOf) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const Lens lens(AnyIntrinsics(random));
    const Vector2d xy = AnyDirection(random);
    const std::optional<Lens::Ray> ray = lens.RayOf(lens.PixelOf(xy));
    ASSERT_TRUE(ray);
    EXPECT_LT((ray->xy - xy).norm(), 1e-11);
  }
}

TEST(Lens, DerivativeAgreesWithDifferences) {
  Random random(3);
  constexpr double kStep = 1e-3;  // px
  for (int i = 0; i < 500; ++i) {
    const Lens lens(AnyIntrinsics(random));
    const Vector2d pixel(random.Uniform(0, 640), random.Uniform(0, 480));
    const std::optional<Lens::Ray> ray = lens.RayOf(pixel);
    ASSERT_TRUE(ray);
    for (int axis = 0; axis < 2; ++axis) {
      const Vector2d step = kStep * Vector2d::Unit(axis);
      const Vector2d difference = (lens.RayOf(pixel + step)->xy - lens.RayOf(pixel - step)->xy) / (2 * kStep);
      EXPECT_LT((ray->dxy_dpixel.col(axis) - difference).norm(), 1e-8);
    }
  }
}

// k1 = -0.5 folds at r = 0.816, distorted 0.544: nothing is seen beyond.
TEST(Lens, GivesNoRayBeyondTheFold) {
  CameraIntrinsics intrinsics{500, 500, 320, 240};
  intrinsics.k1 = -0.5;
  const Lens lens(intrinsics);
  EXPECT_TRUE(lens.RayOf({320 + 0.53 * 500, 240}));
  EXPECT_FALSE(lens.RayOf({320 + 0.56 * 500, 240}));
}

}  // namespace
}  // namespace wirepose::sim
