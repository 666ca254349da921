// 2D segments against edges whose place is known to a thousandth of a pixel.
#include "stages/segments.h"

#include <gtest/gtest.h>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::FindAll;
using testing::GrayImage;
using testing::Paint;
using testing::Random;
using testing::Step;

// A bright or dark bar on grey, seen through a lens; its two long sides are the edges that are
// looked for.
struct Bar {
  Eigen::Vector2d centre, along;
  double length, width, contrast;

  [[nodiscard]] Eigen::Vector2d across() const { return {-along.y(), along.x()}; }
  [[nodiscard]] double Coverage(double x, double y) const {
    const Eigen::Vector2d p = Eigen::Vector2d(x, y) - centre;
    const double u = p.dot(along), v = p.dot(across());
    return (Step(u + length / 2) - Step(u - length / 2)) * (Step(v + width / 2) - Step(v - width / 2));
  }
};

Bar AnyBar(Random& random) {
  const double angle = random.Uniform(0, 2 * M_PI);
  Bar bar;
  bar.centre = {random.Uniform(110, 130), random.Uniform(110, 130)};
  bar.along = {std::cos(angle), std::sin(angle)};
  bar.length = random.Uniform(60, 150);
  bar.width = random.Uniform(20, 45);
  bar.contrast = random.Uniform(15, 90) * (random.Chance(0.5) ? 1 : -1);
  return bar;
}

struct Statistics {
  int looked_for = 0, found = 0;
  double offset_sum = 0, offset_square = 0, offset_normalized = 0;
  double angle_sum = 0, angle_square = 0, angle_normalized = 0;
  int ends_within_two_px = 0;
  double worst_end = 0;
};

// The segment along one side of the bar, if there is one: `side` +1 or -1.
void Judge(const Bar& bar, int side, const Segments& segments, Statistics& out) {
  ++out.looked_for;
  const Eigen::Vector2d middle = bar.centre + side * bar.width / 2 * bar.across();
  for (const Segment2& s : segments.items) {
    const Eigen::Vector2d m = s.Middle().cast<double>(), d = s.Direction().cast<double>();
    const double sine = bar.along.x() * d.y() - bar.along.y() * d.x();
    if (std::abs(sine) > 0.1 || std::abs((m - middle).dot(bar.across())) > 3) continue;
    if (static_cast<double>(s.Length()) < 0.8 * bar.length) continue;
    ++out.found;
    // The brighter side: into the bar where it is bright.
    const Eigen::Vector2d inwards = -side * bar.across();
    EXPECT_GT(s.Normal().cast<double>().dot(inwards) * bar.contrast, 0);
    const double offset = (m - middle).dot(inwards), angle = std::asin(sine * (d.dot(bar.along) > 0 ? 1 : -1));
    out.offset_sum += offset;
    out.offset_square += offset * offset;
    out.offset_normalized += std::pow(offset / static_cast<double>(s.sigma_offset_px), 2);
    out.angle_sum += angle;
    out.angle_square += angle * angle;
    out.angle_normalized += std::pow(angle / static_cast<double>(s.sigma_angle_rad), 2);
    for (const Vector2& end : {s.a, s.b}) {
      const double u = (end.cast<double>() - middle).dot(bar.along);
      const double error = std::abs(std::abs(u) - bar.length / 2);
      out.worst_end = std::max(out.worst_end, error);
      out.ends_within_two_px += error < 2 ? 1 : 0;
    }
    return;
  }
}

Statistics Measure(double noise, int count, std::uint64_t seed) {
  Random random(seed);
  Statistics statistics;
  for (int i = 0; i < count; ++i) {
    Bar bar = AnyBar(random);
    bar.contrast *= 1 + 0.2 * noise;
    const auto planes = FindAll(Paint(240, 240, [&](int x, int y) {
      return 120 + bar.contrast * bar.Coverage(x, y) + noise * testing::Gaussian(random);
    }));
    for (const int side : {1, -1}) Judge(bar, side, planes->segments, statistics);
  }
  return statistics;
}

// Found nearly always, without bias, and as wrong as their sigma says.
void Expect(const Statistics& s, double max_offset_rms, double max_angle_rms) {
  const double n = s.found;
  EXPECT_GE(s.found, 0.97 * s.looked_for);
  EXPECT_LT(std::abs(s.offset_sum / n), 0.03);
  EXPECT_LT(std::abs(s.angle_sum / n), 0.001);
  EXPECT_LT(std::sqrt(s.offset_square / n), max_offset_rms);
  EXPECT_LT(std::sqrt(s.angle_square / n), max_angle_rms);
  EXPECT_LT(std::sqrt(s.offset_normalized / n), 2.5);
  EXPECT_LT(std::sqrt(s.angle_normalized / n), 2.5);
  EXPECT_GT(std::sqrt(s.offset_normalized / n), 0.2);
  // Corners are rounded by the lens and the filter.
  EXPECT_GT(s.ends_within_two_px, 0.75 * 2 * n);
  ::testing::Test::RecordProperty("offset_rms_px", std::to_string(std::sqrt(s.offset_square / n)));
  ::testing::Test::RecordProperty("angle_rms_rad", std::to_string(std::sqrt(s.angle_square / n)));
  ::testing::Test::RecordProperty("worst_end_px", std::to_string(s.worst_end));
  printf(
      "found %d of %d, offset rms %.3f px (%.2f sigma), angle rms %.5f rad (%.2f sigma), ends %.2f "
      "within 2 px, worst %.2f px\n",
      s.found, s.looked_for, std::sqrt(s.offset_square / n), std::sqrt(s.offset_normalized / n),
      std::sqrt(s.angle_square / n), std::sqrt(s.angle_normalized / n), 0.5 * s.ends_within_two_px / n, s.worst_end);
}

TEST(SegmentFinding, CleanEdges) {
  const Statistics s = Measure(0, Cases(150), 1);
  Expect(s, 0.06, 0.002);
  EXPECT_LT(s.worst_end, 7);
}

TEST(SegmentFinding, NoisyEdges) {
  const Statistics s = Measure(3, Cases(150), 2);
  Expect(s, 0.12, 0.004);
  EXPECT_LT(s.worst_end, 15);
}

// What holds for every image.
void ExpectSound(const GrayImage& image, const Segments& segments) {
  for (std::size_t i = 0; i < segments.items.size(); ++i) {
    const Segment2& s = segments.items[i];
    for (const Vector2& p : {s.a, s.b}) {
      ASSERT_TRUE(p.allFinite());
      ASSERT_TRUE(p.x() > 1 && p.y() > 1 && p.x() < static_cast<float>(image.width - 2) &&
                  p.y() < static_cast<float>(image.height - 2));
    }
    ASSERT_GE(s.Length(), SegmentParams{}.min_length_px - 0.01F);
    ASSERT_TRUE(s.sigma_offset_px > 0 && s.sigma_angle_rad > 0 && s.contrast > 0);
    ASSERT_LE(s.Length(), segments.items[i == 0 ? 0 : i - 1].Length());
  }
}

TEST(SegmentFinding, ExtremeImages) {
  Random random(3);
  const auto tile = [](int x, int y, int size) { return (x / size + y / size) % 2 == 0 ? 0 : 255; };
  struct Case {
    const char* name;
    std::function<double(int, int)> level;
    std::size_t min, max;
  };
  const Case cases[] = {
      {"black", [](int, int) { return 0; }, 0, 0},
      {"white", [](int, int) { return 255; }, 0, 0},
      {"ramp", [](int x, int) { return 0.4 * x; }, 0, 0},
      {"noise", [&](int, int) { return random.Uniform(0, 256); }, 0, 200},
      {"checker of 1 px", [&](int x, int y) { return tile(x, y, 1); }, 0, kMaxSegments},
      {"checker of 4 px", [&](int x, int y) { return tile(x, y, 4); }, 0, kMaxSegments},
      {"grating", [](int x, int) { return x % 8 < 4 ? 0 : 255; }, 100, kMaxSegments},
      {"flat grating", [](int, int y) { return y % 8 < 4 ? 0 : 255; }, 80, kMaxSegments},
      {"slanted grating", [](int x, int y) { return 127 + 127 * std::sin(0.5 * x + 0.3 * y); }, 50, kMaxSegments},
      {"rings", [](int x, int y) { return 127 + 127 * std::sin(0.3 * std::hypot(x - 320, y - 240)); }, 0, kMaxSegments},
  };
  for (const Case& c : cases) {
    const GrayImage image = Paint(640, 480, c.level);
    const auto planes = FindAll(image);
    SCOPED_TRACE(c.name);
    EXPECT_GE(planes->segments.items.size(), c.min);
    EXPECT_LE(planes->segments.items.size(), c.max);
    ExpectSound(image, planes->segments);
  }
}

// 1040 sides of tiles: the longest 512 are kept, the others counted.
TEST(SegmentFinding, OverflowIsCounted) {
  const GrayImage image = Paint(640, 480, [](int x, int y) { return (x / 24 + y / 24) % 2 == 0 ? 40 : 200; });
  const auto planes = FindAll(image);
  EXPECT_GT(planes->segments.dropped, 100U);
  EXPECT_GT(planes->segments.items.size(), 400U);
  ExpectSound(image, planes->segments);
}

// A gap that is short against the edge is bridged; where contrast is inverted the line ends.
TEST(SegmentFinding, JoinsAcrossGapsButNotAcrossPolarity) {
  const auto count_long = [](const std::function<double(int, int)>& level) {
    const auto planes = FindAll(Paint(300, 100, level));
    int count = 0;
    for (const Segment2& s : planes->segments.items) count += s.Length() > 200 ? 1 : 0;
    return count;
  };
  const auto edge = [](int y) { return Step(y - 50.3); };
  EXPECT_EQ(count_long([&](int x, int y) { return x > 140 && x < 160 ? 100 : 100 + 60 * edge(y); }), 1);
  EXPECT_EQ(count_long([&](int x, int y) { return x < 150 ? 100 + 60 * edge(y) : 160 - 60 * edge(y); }), 0);
}

// A circle of radius 40 is no line: only chords that stay within a pixel of the arc.
TEST(SegmentFinding, CurvesGiveShortChords) {
  const auto planes =
      FindAll(Paint(200, 200, [](int x, int y) { return 60 + 100 * Step(40 - std::hypot(x - 100, y - 100)); }));
  for (const Segment2& s : planes->segments.items) EXPECT_LT(s.Length(), 45);
}

TEST(SegmentFinding, SameImageSameBytes) {
  Random random(8);
  const GrayImage image = Paint(
      320, 240, [&](int x, int y) { return 128 + 80 * testing::Texture(x, y, 17, 3) + 3 * testing::Gaussian(random); });
  const auto first = FindAll(image), second = FindAll(image);
  ASSERT_EQ(first->segments.items.size(), second->segments.items.size());
  for (std::size_t i = 0; i < first->segments.items.size(); ++i) {
    EXPECT_TRUE(first->segments.items[i].a == second->segments.items[i].a);
    EXPECT_TRUE(first->segments.items[i].b == second->segments.items[i].b);
  }
}

}  // namespace
}  // namespace wirepose
