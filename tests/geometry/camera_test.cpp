// The rectified camera: projection, its inverse, and the right eye.
#include "geometry/camera.h"

#include <gtest/gtest.h>

#include "geometry/segment2.h"
#include "sim/random.h"

namespace wirepose {
namespace {

RectifiedCamera AnyCamera(sim::Random& random) {
  return {random.Uniform(200, 900),
          random.Uniform(200, 400),
          random.Uniform(150, 300),
          random.Uniform(0.03, 0.3),
          640,
          480};
}

TEST(Rectified, TriangulateInvertsProject) {
  sim::Random random(1);
  for (int i = 0; i < 5000; ++i) {
    const RectifiedCamera camera = AnyCamera(random);
    const double z = std::pow(10.0, random.Uniform(-1, 2));
    const Vector3d p(z * random.Uniform(-1, 1), z * random.Uniform(-1, 1), z);
    const Vector3d u = camera.Project(p);
    EXPECT_LT((camera.Triangulate(u.x(), u.y(), u.z()) - p).norm(), 1e-12 * z);
    EXPECT_DOUBLE_EQ(u.z(), camera.DisparityOfDepth(z));
  }
}

// The right eye is an equal pinhole one baseline to the right: same row, column less by the
// disparity.
TEST(Rectified, DisparityIsTheRightEyesShift) {
  sim::Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const RectifiedCamera camera = AnyCamera(random);
    const Vector3d p(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(0.3, 5));
    const Vector3d left = camera.Project(p), right = camera.Project(p - Vector3d(camera.baseline, 0, 0));
    EXPECT_NEAR(left.x() - left.z(), right.x(), 1e-10);
    EXPECT_DOUBLE_EQ(left.y(), right.y());
  }
}

TEST(Rectified, PrincipalPointLooksStraightAhead) {
  const RectifiedCamera camera{500, 320, 240, 0.1, 640, 480};
  EXPECT_TRUE(camera.Project({0, 0, 2}) == Vector3d(320, 240, 25));
  EXPECT_TRUE(camera.Triangulate(320, 240, 25) == Vector3d(0, 0, 2));
}

// Walking from a to b the brighter side is on the right hand: down the image, it is to the west.
TEST(Segment, NormalPointsToTheRightOfTheDirectionOfTravel) {
  Segment2 s;
  s.a = {10, 10};
  s.b = {10, 30};
  EXPECT_TRUE(s.Normal() == Vector2(-1, 0));
  EXPECT_TRUE(s.Direction() == Vector2(0, 1));
  EXPECT_FLOAT_EQ(s.Length(), 20);
  EXPECT_TRUE(s.Middle() == Vector2(10, 20));
}

}  // namespace
}  // namespace wirepose
