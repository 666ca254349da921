// Lines in exact depth images: on planes, at outlines, in holes, among made-up pixels.
#include "stages/depth_lines.h"

#include <gtest/gtest.h>

#include "depth_scene.h"

namespace wirepose {
namespace {

using testing::DepthCamera;
using testing::DepthImage;
using testing::DisparitiesOf;
using testing::PaintDepth;
using testing::PlaneDepth;
using testing::Random;

// The bright side is to the right of a -> b.
Segments Single(const Vector2& a, const Vector2& b) {
  Segments segments;
  Segment2 s;
  s.a = a;
  s.b = b;
  s.sigma_offset_px = 0.1F;
  segments.items.push_back(s);
  return segments;
}

Line3 Place(const RectifiedCamera& camera, const DepthImage& depth, const Vector2& a, const Vector2& b) {
  const auto image = DisparitiesOf(camera, depth);
  static Lines3 lines;
  PlaceLines({}, camera, *image, Single(a, b), lines);
  EXPECT_EQ(lines.size(), 1U);
  return lines[0];
}

double ErrorAt(const RectifiedCamera& camera, const Vector3& p, const Vector3d& n, double c) {
  const double u = camera.f * static_cast<double>(p.x() / p.z()) + camera.cx;
  const double v = camera.f * static_cast<double>(p.y() / p.z()) + camera.cy;
  return std::abs(static_cast<double>(p.z()) - PlaneDepth(camera, n, c, u, v));
}

constexpr int kWidth = 320, kHeight = 240;
const RectifiedCamera kCamera = DepthCamera(kWidth, kHeight, 400);

// Print on a plane of any slant: both sides agree, and both ends lie on it.
TEST(DepthLines, LieOnPlanes) {
  Random random(1);
  for (int k = 0; k < testing::Cases(200); ++k) {
    Vector3d n = testing::AnyDirection(random);
    n.z() = std::abs(n.z()) + 0.8;
    n.normalize();
    const double c = random.Uniform(0.4, 2.0) * n.z();
    const DepthImage depth = PaintDepth(kWidth, kHeight, [&](int x, int y) {
      const double z = PlaneDepth(kCamera, n, c, x, y);
      return z > 0.1 && z < 6 ? z : 0;
    });
    const Vector2 a(random.Uniform(40, 280), random.Uniform(40, 200));
    const double turn = random.Uniform(0, 6.28), length = random.Uniform(16, 90);
    const Vector2 b =
        a + Vector2(static_cast<float>(length * std::cos(turn)), static_cast<float>(length * std::sin(turn)));
    if (b.x() < 20 || b.y() < 20 || b.x() > 300 || b.y() > 220) continue;
    const Line3 line = Place(kCamera, depth, a, b);
    if (line.a.z() > 3 || line.b.z() > 3) continue;
    ASSERT_TRUE(line.has_depth) << k;
    EXPECT_EQ(line.owner, LineOwner::kBoth) << k;
    EXPECT_LT(ErrorAt(kCamera, line.a, n, c), 0.006 * static_cast<double>(line.a.z())) << k;
    EXPECT_LT(ErrorAt(kCamera, line.b, n, c), 0.006 * static_cast<double>(line.b.z())) << k;
  }
}

// An outline: whichever side is near owns the edge, also where the depth's outline is some pixels off the image's.
TEST(DepthLines, TheNearSideOwnsAnOutline) {
  for (const int shift : {-2, 0, 2}) {
    for (const bool near_is_right : {true, false}) {
      const auto near = [&](int x) { return (x < 160 + shift) != near_is_right; };
      const DepthImage depth = PaintDepth(kWidth, kHeight, [&](int x, int) { return near(x) ? 0.6 : 1.0; });
      // Upwards the normal points right: (dy -> -1): normal (-dy, dx) = (1, 0).
      const Line3 line = Place(kCamera, depth, {159.5F, 160}, {159.5F, 80});
      ASSERT_TRUE(line.has_depth);
      EXPECT_EQ(line.owner, near_is_right ? LineOwner::kBright : LineOwner::kDark);
      EXPECT_NEAR(line.a.z(), 0.6, 0.003) << shift;
      EXPECT_NEAR(line.b.z(), 0.6, 0.003) << shift;
    }
  }
}

// Where two faces meet, the line is on both.
TEST(DepthLines, AConvexEdgeBelongsToBothFaces) {
  const Vector3d left = Vector3d(0.6, 0, -1).normalized(), right = Vector3d(-0.5, 0, -1).normalized();
  const Vector3d corner(0, 0, 0.7);
  const DepthImage depth = PaintDepth(kWidth, kHeight, [&](int x, int y) {
    // The body is behind both planes: the later one is seen.
    return std::max(PlaneDepth(kCamera, left, left.dot(corner), x, y),
                    PlaneDepth(kCamera, right, right.dot(corner), x, y));
  });
  const Line3 line = Place(kCamera, depth, {159.5F, 160}, {159.5F, 80});
  ASSERT_TRUE(line.has_depth);
  EXPECT_EQ(line.owner, LineOwner::kBoth);
  EXPECT_NEAR(line.a.z(), 0.7, 0.003);
  EXPECT_NEAR(line.b.z(), 0.7, 0.003);
}

// Half of the pixels missing costs nothing; all missing leaves a line of the image alone.
TEST(DepthLines, HolesAreTolerated) {
  Random random(2);
  const auto with_holes = [&](double share) {
    return PaintDepth(kWidth, kHeight, [&](int, int) { return random.Uniform(0, 1) < share ? 0 : 0.8; });
  };
  const Line3 half = Place(kCamera, with_holes(0.5), {100, 100}, {180, 130});
  ASSERT_TRUE(half.has_depth);
  EXPECT_NEAR(half.a.z(), 0.8, 0.003);
  for (const double share : {0.95, 1.0}) {
    const Line3 none = Place(kCamera, with_holes(share), {100, 100}, {180, 130});
    EXPECT_FALSE(none.has_depth) << share;
    EXPECT_EQ(none.segment.a.x(), 100);
  }
  // A shadow without depth beyond an outline.
  const DepthImage shadow = PaintDepth(kWidth, kHeight, [](int x, int) { return x < 160 ? 0.6 : 0; });
  const Line3 line = Place(kCamera, shadow, {159.5F, 160}, {159.5F, 80});
  ASSERT_TRUE(line.has_depth);
  EXPECT_EQ(line.owner, LineOwner::kDark);
  EXPECT_NEAR(line.a.z(), 0.6, 0.003);
}

// A quarter of the pixels says anything: the plane stays, the variance tells the noise.
TEST(DepthLines, MadeUpPixelsDoNotPull) {
  Random random(3);
  for (int k = 0; k < testing::Cases(100); ++k) {
    const DepthImage depth = PaintDepth(kWidth, kHeight, [&](int, int) {
      return random.Uniform(0, 1) < 0.06 ? random.Uniform(0.3, 3) : 0.8 + 0.0005 * testing::Gaussian(random);
    });
    const Line3 line = Place(kCamera, depth, {100, 100}, {170, 150});
    ASSERT_TRUE(line.has_depth);
    EXPECT_NEAR(line.a.z(), 0.8, 0.01);
    EXPECT_NEAR(line.b.z(), 0.8, 0.01);
  }
}

// With independent noise the errors are within the stated deviation, which also holds what a sensor shares.
TEST(DepthLines, CovarianceCoversTheError) {
  Random random(4);
  int within = 0, count = 0;
  for (int k = 0; k < testing::Cases(200); ++k) {
    const DepthImage depth =
        PaintDepth(kWidth, kHeight, [&](int, int) { return 0.8 + 0.003 * testing::Gaussian(random); });
    const Line3 line = Place(kCamera, depth, {100, 100}, {140, 150});
    if (!line.has_depth) continue;
    EXPECT_GT(line.var_a * line.var_b, line.cov_ab * line.cov_ab);
    const double error = std::abs(static_cast<double>(line.disparity_a_px) - kCamera.DisparityOfDepth(0.8));
    within += error < 2 * std::sqrt(static_cast<double>(line.var_a)) ? 1 : 0;
    ++count;
  }
  EXPECT_GE(count, testing::Cases(190));
  EXPECT_GE(within, 0.95 * count);
}

TEST(DepthLines, TheImageBorderIsNoPlaceToRead) {
  const DepthImage depth = PaintDepth(kWidth, kHeight, [](int, int) { return 0.8; });
  for (const auto& [a, b] : {std::pair(Vector2(0, 0), Vector2(319, 0)),
                             {Vector2(319, 239), Vector2(319, 0)},
                             {Vector2(0, 239), Vector2(319, 0)},
                             {Vector2(1, 1), Vector2(13, 1)}}) {
    const Line3 line = Place(kCamera, depth, a, b);
    if (!line.has_depth) continue;
    EXPECT_NEAR(line.a.z(), 0.8, 0.01);
  }
}

}  // namespace
}  // namespace wirepose
