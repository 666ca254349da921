// 3D lines from pairs that are painted by formula: the right image is the left one displaced by an
// exact disparity.
#include "stages/stereo_lines.h"

#include <gtest/gtest.h>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::GrayImage;
using testing::Planes;
using testing::Random;
using testing::Step;

// d = a u + b v + c in left pixels.
struct Plane {
  double a = 0, b = 0, c = 0;
  [[nodiscard]] double At(double u, double v) const { return a * u + b * v + c; }
  // The left column whose point appears at right column `u`.
  [[nodiscard]] double LeftOf(double u, double v) const { return (u + b * v + c) / (1 - a); }
};

using Picture = std::function<double(double, double)>;

struct Pair {
  std::unique_ptr<Planes> left, right;
};

// The right eye is darker and noisy in its own way, as real ones are.
Pair See(const Picture& left, const Picture& right, double noise, Random& random) {
  return {testing::FindAll(
              testing::Paint(640, 240, [&](int x, int y) { return left(x, y) + noise * testing::Gaussian(random); })),
          testing::FindAll(testing::Paint(
              640, 240, [&](int x, int y) { return 10 + 0.8 * right(x, y) + noise * testing::Gaussian(random); }))};
}

RectifiedCamera Camera() { return testing::TestCamera(640, 240); }

std::unique_ptr<Lines3> Match(const Pair& pair) {
  const RectifiedCamera camera = Camera();
  const auto whole = testing::WholeImage(640, 240);
  const auto scratch = std::make_unique<StereoScratch>();
  auto lines = std::make_unique<Lines3>();
  MatchLines({}, {camera, pair.left->normalized, pair.right->normalized, pair.right->smooth, *whole},
             pair.left->segments, *scratch, *lines);
  return lines;
}

// Grey polygons with straight sides on a fine texture.
Picture Shapes(Random& random) {
  struct Shape {
    double x, y, cosine, sine, length, width, contrast;
  };
  std::vector<Shape> shapes;
  for (int i = 0; i < 9; ++i) {
    const double angle = random.Uniform(0, M_PI);
    shapes.push_back({100 + 60.0 * i, random.Uniform(80, 160), std::cos(angle), std::sin(angle), random.Uniform(50, 90),
                      random.Uniform(16, 30), random.Uniform(30, 60) * (random.Chance(0.5) ? 1 : -1)});
  }
  const std::uint64_t seed = random.Next();
  return [shapes, seed](double x, double y) {
    double level = 120 + 14 * testing::Texture(x, y, 5, seed);
    for (const Shape& s : shapes) {
      const double u = (x - s.x) * s.cosine + (y - s.y) * s.sine, v = -(x - s.x) * s.sine + (y - s.y) * s.cosine;
      level += s.contrast * (Step(u + s.length / 2) - Step(u - s.length / 2)) *
               (Step(v + s.width / 2) - Step(v - s.width / 2));
    }
    return level;
  };
}

struct Outcome {
  int lines = 0, matched = 0, right = 0;
  int ends = 0, within_one = 0, within_two = 0;
};

void Judge(const Lines3& lines, const Plane& plane, bool flat, Outcome& out) {
  for (const Line3& line : lines) {
    if (line.segment.Length() < 25) continue;
    const double slope = static_cast<double>(std::abs(line.segment.Direction().y()));
    if (flat != (slope < 0.2)) continue;
    ++out.lines;
    if (!line.has_depth) continue;
    ++out.matched;
    const double ea = static_cast<double>(line.disparity_a_px) -
                      plane.At(static_cast<double>(line.segment.a.x()), static_cast<double>(line.segment.a.y()));
    const double eb = static_cast<double>(line.disparity_b_px) -
                      plane.At(static_cast<double>(line.segment.b.x()), static_cast<double>(line.segment.b.y()));
    if (std::max(std::abs(ea), std::abs(eb)) < 1.5) ++out.right;
    for (const auto& [error, variance] : {std::pair(ea, line.var_a), std::pair(eb, line.var_b)}) {
      ++out.ends;
      if (error * error < static_cast<double>(variance)) ++out.within_one;
      if (error * error < 4 * static_cast<double>(variance)) ++out.within_two;
    }
  }
}

void Print(const char* what, const Outcome& o) {
  printf("%s: %d lines, %d matched, %d within 1.5 px; coverage %.2f at 1 sigma, %.2f at 2 sigma\n", what, o.lines,
         o.matched, o.right, 1.0 * o.within_one / o.ends, 1.0 * o.within_two / o.ends);
}

TEST(StereoMatching, DisparityOfTexturedPlanes) {
  Random random(1);
  Outcome steep, flat;
  for (int k = 0; k < Cases(20); ++k) {
    const Plane plane{random.Uniform(-0.12, 0.12), random.Uniform(-0.12, 0.12), random.Uniform(45, 80)};
    const Picture picture = Shapes(random);
    const Pair pair = See(
        picture, [&](double u, double v) { return picture(plane.LeftOf(u, v), v); }, 1.5, random);
    const auto lines = Match(pair);
    Judge(*lines, plane, false, steep);
    Judge(*lines, plane, true, flat);
  }
  Print("steep", steep);
  Print("flat", flat);
  EXPECT_GT(steep.lines, Cases(20) * 8);
  EXPECT_GT(steep.matched, 0.9 * steep.lines);
  EXPECT_GT(steep.right, 0.95 * steep.matched);
  EXPECT_GT(steep.within_one, 0.5 * steep.ends);
  EXPECT_GT(steep.within_two, 0.85 * steep.ends);
  EXPECT_GT(flat.right, 0.7 * flat.matched);
}

// What the record says of itself: order, ids, end points in space, covariance.
TEST(StereoMatching, RecordsAreConsistent) {
  Random random(2);
  const Plane plane{0.05, -0.08, 50};
  const Picture picture = Shapes(random);
  const Pair pair = See(
      picture, [&](double u, double v) { return picture(plane.LeftOf(u, v), v); }, 1, random);
  const auto lines = Match(pair);
  ASSERT_EQ(lines->size(), pair.left->segments.items.size());
  int with_depth = 0;
  for (std::size_t i = 0; i < lines->size(); ++i) {
    const Line3& line = (*lines)[i];
    EXPECT_EQ(line.id, i);
    EXPECT_TRUE(line.segment.a == pair.left->segments.items[i].a);
    if (!line.has_depth) continue;
    ++with_depth;
    EXPECT_GE(line.disparity_a_px, 1);
    EXPECT_LT(line.disparity_a_px, kMaxDisparity + 1);
    EXPECT_GT(line.var_a, 0);
    EXPECT_GT(line.var_a * line.var_b, line.cov_ab * line.cov_ab);
    const Vector3d a = Camera().Project(line.a.cast<double>());
    EXPECT_LT((a.head<2>() - line.segment.a.cast<double>()).norm(), 1e-3);
    EXPECT_NEAR(a.z(), static_cast<double>(line.disparity_a_px), 1e-3);
  }
  EXPECT_GT(with_depth, 8);
}

// A near bar before a far wall: its steep sides have its disparity, not the wall's, and never
// belong to the wall.
TEST(StereoMatching, OccludingEdgeBelongsToTheNearSide) {
  Random random(3);
  int sides = 0, near = 0, owned_by_far = 0;
  for (int k = 0; k < 12; ++k) {
    const double near_d = random.Uniform(40, 70), far_d = random.Uniform(10, 25), tilt = random.Uniform(-0.3, 0.3);
    const double contrast = random.Uniform(30, 60) * (random.Chance(0.5) ? 1 : -1);
    const std::uint64_t seed = random.Next();
    // In left coordinates; `shift` moves the bar and the wall by their disparities.
    const auto picture = [=](double x, double y, double near_shift, double far_shift) {
      const double u = x + near_shift - 300 - tilt * (y - 120);
      const double inside = Step(u + 45) - Step(u - 45);
      const double wall = 120 + 35 * testing::Texture(x + far_shift, y, 5, seed);
      const double bar = 120 + contrast + 35 * testing::Texture(x + near_shift, y, 5, seed + 1);
      return inside * bar + (1 - inside) * wall;
    };
    const Pair pair = See([&](double x, double y) { return picture(x, y, 0, 0); },
                          [&](double x, double y) { return picture(x, y, near_d, far_d); }, 1, random);
    const auto lines = Match(pair);
    for (const Line3& line : *lines) {
      const Vector2 m = line.segment.Middle();
      const double u = static_cast<double>(m.x()) - 300 - tilt * (static_cast<double>(m.y()) - 120);
      if (std::abs(std::abs(u) - 45) > 2 || line.segment.Length() < 60 || !line.has_depth) continue;
      ++sides;
      if (std::abs(static_cast<double>(0.5F * (line.disparity_a_px + line.disparity_b_px)) - near_d) < 1) ++near;
      if (line.owner == LineOwner::kBoth) continue;
      const bool bar_is_right = u < 0;
      const bool bright_is_right = line.segment.Normal().x() > 0;
      if ((line.owner == LineOwner::kBright) != (bar_is_right == bright_is_right)) ++owned_by_far;
    }
  }
  printf("%d sides, %d at the near depth, %d owned by the far side\n", sides, near, owned_by_far);
  EXPECT_GT(sides, 8);
  EXPECT_GT(near, 0.9 * sides);
  EXPECT_LE(owned_by_far, 0.1 * sides);
}

// Nothing to see in the right image: no depth, rather than any.
TEST(StereoMatching, BlankRightImageGivesNoDepth) {
  Random random(4);
  const Picture picture = Shapes(random);
  const Pair pair = See(
      picture, [](double, double) { return 120; }, 0, random);
  const auto lines = Match(pair);
  EXPECT_GT(lines->size(), 8U);
  for (const Line3& line : *lines) EXPECT_FALSE(line.has_depth);
}

}  // namespace
}  // namespace wirepose
