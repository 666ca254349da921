// Line sets of the image against geometry in double precision.
#include "stages/line_sets.h"

#include <gtest/gtest.h>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;

Line3 MakeLine(const RectifiedCamera& camera, const Vector3d& a, const Vector3d& b, float sigma_px = 0.1F) {
  Line3 line;
  line.has_depth = true;
  line.a = a.cast<float>();
  line.b = b.cast<float>();
  const Vector3d pa = camera.Project(a), pb = camera.Project(b);
  line.segment.a = pa.head<2>().cast<float>();
  line.segment.b = pb.head<2>().cast<float>();
  line.segment.sigma_offset_px = 0.05F;
  line.disparity_a_px = static_cast<float>(pa.z());
  line.disparity_b_px = static_cast<float>(pb.z());
  line.var_a = line.var_b = sigma_px * sigma_px;
  return line;
}

Line3 AnyLine(Random& random, const RectifiedCamera& camera) {
  while (true) {
    const double z = random.Uniform(0.6, 1.5);
    const Vector3d a = z * Vector3d(random.Uniform(-0.5, 0.5), random.Uniform(-0.4, 0.4), 1);
    const Vector3d b = a + random.Uniform(0.1, 0.5) * testing::AnyDirection(random);
    const Line3 line = MakeLine(camera, a, b);
    if (b.z() > 0.3 && line.segment.Length() > 20) return line;
  }
}

void Add(Lines3& lines, Line3 line) {
  line.id = static_cast<std::uint16_t>(lines.size());
  lines.push_back(line);
}

struct Sets {
  Lines3 lines;
  ImageLineSets sets;
};

double AngleOf(const Line3& p, const Line3& q) {
  const Vector3d u = (p.b - p.a).cast<double>(), v = (q.b - q.a).cast<double>();
  return std::atan2(u.cross(v).norm(), std::abs(u.dot(v)));
}

double DistanceOf(const Line3& p, const Line3& q) {
  const Vector3d n = (p.b - p.a).cast<double>().cross((q.b - q.a).cast<double>());
  return std::abs(n.normalized().dot((q.a - p.a).cast<double>()));
}

double FarthestOf(const Line3& p, const Line3& q) {
  double farthest = 0;
  for (const Vector3& s : {p.a, p.b}) {
    for (const Vector3& t : {q.a, q.b}) farthest = std::max(farthest, static_cast<double>((s - t).norm()));
  }
  return farthest;
}

TEST(ParameterVector, AgreesWithGeometry) {
  Random random(1);
  const RectifiedCamera camera = testing::TestCamera();
  const auto s = std::make_unique<Sets>();
  int checked = 0;
  for (int k = 0; k < Cases(3000); ++k) {
    s->lines.clear();
    for (int i = 0; i < 2; ++i) Add(s->lines, AnyLine(random, camera));
    FindLineSets({}, camera, s->lines, s->sets);
    ASSERT_LE(s->sets.pairs.size(), 1U);
    if (s->sets.pairs.empty()) {
      EXPECT_GT(FarthestOf(s->lines[0], s->lines[1]), 1.9);
      continue;
    }
    const ImageLinePair& pair = s->sets.pairs[0];
    const Line3 &p = s->lines[pair.base], &q = s->lines[pair.other];
    const double angle = AngleOf(p, q);
    EXPECT_TRUE(pair.metric);
    EXPECT_NEAR(static_cast<double>(pair.angle_rad), angle, 0.006);
    EXPECT_NEAR(static_cast<double>(pair.farthest_end_m), FarthestOf(p, q), 1e-4);
    if (std::sin(angle) > 0.25) {
      EXPECT_NEAR(static_cast<double>(pair.distance_m), DistanceOf(p, q), 1e-4);
    }
    const bool parallel = angle < static_cast<double>(LineSetParams{}.parallel_rad + pair.angle_sigma_rad);
    if (std::abs(angle - static_cast<double>(LineSetParams{}.parallel_rad + pair.angle_sigma_rad)) > 0.01) {
      EXPECT_EQ(pair.kind == LineSetKind::kParallel, parallel);
    }
    ++checked;
  }
  EXPECT_GT(checked, Cases(3000) / 2);
}

TEST(ParameterVector, ExactParallels) {
  Random random(2);
  const RectifiedCamera camera = testing::TestCamera();
  const auto s = std::make_unique<Sets>();
  for (int k = 0; k < Cases(1000); ++k) {
    const Line3 base = AnyLine(random, camera);
    const Vector3d d = (base.b - base.a).cast<double>();
    const Vector3d across = d.cross(testing::AnyDirection(random)).normalized() * random.Uniform(0.02, 0.2);
    const Vector3d a = base.a.cast<double>() + across + 0.2 * d, b = a + 0.7 * d;
    const Line3 other = MakeLine(camera, a, b);
    if (other.segment.Length() < 12 || a.z() < 0.3 || b.z() < 0.3) continue;
    s->lines.clear();
    Add(s->lines, base);
    Add(s->lines, other);
    FindLineSets({}, camera, s->lines, s->sets);
    ASSERT_EQ(s->sets.pairs.size(), 1U);
    EXPECT_EQ(s->sets.pairs[0].kind, LineSetKind::kParallel);
    EXPECT_NEAR(static_cast<double>(s->sets.pairs[0].distance_m), across.norm(), 1e-4);
    EXPECT_NEAR(s->sets.pairs[0].angle_rad, 0, 0.01);
  }
}

// A line without depth belongs to a set only through a junction; which ends meet is told.
TEST(Junctions, LineWithoutDepthNeedsOne) {
  const RectifiedCamera camera = testing::TestCamera();
  const auto s = std::make_unique<Sets>();
  const Line3 base = MakeLine(camera, {0, 0, 1}, {0.2, 0.02, 1});
  for (const double gap_px : {0.0, 5.0, 13.0, 20.0, 60.0}) {
    for (const bool turned : {false, true}) {
      Line3 flat;
      flat.segment.a = base.segment.b + Vector2(static_cast<float>(gap_px), 0);
      flat.segment.b = flat.segment.a + Vector2(5, 70);
      if (turned) std::swap(flat.segment.a, flat.segment.b);
      s->lines.clear();
      Add(s->lines, base);
      Add(s->lines, flat);
      FindLineSets({}, camera, s->lines, s->sets);
      ASSERT_EQ(s->sets.pairs.size(), gap_px < 14 ? 1U : 0U) << gap_px;
      if (s->sets.pairs.empty()) continue;
      const ImageLinePair& pair = s->sets.pairs[0];
      EXPECT_FALSE(pair.metric);
      EXPECT_EQ(pair.base, 0);
      EXPECT_EQ(pair.base_end, LineEnd::kB);
      EXPECT_EQ(pair.other_end, turned ? LineEnd::kB : LineEnd::kA);
    }
  }
}

double QualityOf(const RectifiedCamera& camera, const Line3& p, const Line3& q) {
  const double lengths = static_cast<double>(p.segment.Length()) * static_cast<double>(q.segment.Length());
  const double depth = 0.5 * static_cast<double>(p.a.z() + p.b.z());
  return lengths * std::pow(depth / (camera.f * FarthestOf(p, q)), 2);
}

// Long lines near each other rank first, all the more when they meet.
TEST(Quality, IsLengthsOverReach) {
  Random random(6);
  const RectifiedCamera camera = testing::TestCamera();
  const auto s = std::make_unique<Sets>();
  int met = 0;
  for (int k = 0; k < Cases(3000); ++k) {
    s->lines.clear();
    const Line3 base = AnyLine(random, camera);
    Line3 other = AnyLine(random, camera);
    if (k % 2 == 0) {
      const Vector3d far = base.b.cast<double>() + 0.2 * testing::AnyDirection(random);
      if (far.z() < 0.3) continue;
      other = MakeLine(camera, base.b.cast<double>(), far);
    }
    Add(s->lines, base);
    Add(s->lines, other);
    FindLineSets({}, camera, s->lines, s->sets);
    if (s->sets.pairs.empty()) continue;
    const ImageLinePair& pair = s->sets.pairs[0];
    const bool meet = pair.base_end != LineEnd::kNone;
    const double expected =
        QualityOf(camera, base, other) * (meet ? static_cast<double>(LineSetParams{}.junction_gain) : 1.0);
    EXPECT_NEAR(static_cast<double>(pair.quality) / expected, 1, 1e-4);
    met += meet ? 1 : 0;
  }
  EXPECT_GT(met, Cases(3000) / 4);
}

TEST(Grouping, EveryPairIsFoundUnderItsBase) {
  Random random(3);
  const RectifiedCamera camera = testing::TestCamera();
  const auto s = std::make_unique<Sets>();
  for (int i = 0; i < 60; ++i) Add(s->lines, AnyLine(random, camera));
  FindLineSets({}, camera, s->lines, s->sets);
  EXPECT_EQ(s->sets.dropped, 0U);
  std::size_t sum = 0;
  for (std::size_t b = 0; b < s->lines.size(); ++b) {
    for (const ImageLinePair& pair : s->sets.OfBase(b)) {
      EXPECT_EQ(pair.base, b);
      EXPECT_GT(pair.other, b);
      ++sum;
    }
  }
  EXPECT_EQ(sum, s->sets.pairs.size());
}

TEST(Grouping, NoLinesNoSets) {
  const auto s = std::make_unique<Sets>();
  FindLineSets({}, testing::TestCamera(), s->lines, s->sets);
  EXPECT_TRUE(s->sets.pairs.empty());
}

// Each pair's quality depends on its two lines alone, so that the oracle can ask for one pair at a
// time.
TEST(Grouping, OverflowKeepsTheBest) {
  Random random(4);
  const RectifiedCamera camera = testing::TestCamera();
  const auto all = std::make_unique<Sets>(), one = std::make_unique<Sets>();
  for (int i = 0; i < 160; ++i) Add(all->lines, AnyLine(random, camera));
  FindLineSets({}, camera, all->lines, all->sets);
  std::vector<float> quality;
  for (std::size_t b = 0; b < all->lines.size(); ++b) {
    for (std::size_t o = b + 1; o < all->lines.size(); ++o) {
      one->lines.clear();
      Add(one->lines, all->lines[b]);
      Add(one->lines, all->lines[o]);
      FindLineSets({}, camera, one->lines, one->sets);
      for (const ImageLinePair& pair : one->sets.pairs) quality.push_back(pair.quality);
    }
  }
  ASSERT_GT(quality.size(), kMaxImageLinePairs);
  EXPECT_EQ(all->sets.pairs.size(), kMaxImageLinePairs);
  // Pairs that could not have ranked are not even measured, and not counted.
  EXPECT_GT(all->sets.dropped, 0U);
  EXPECT_LE(all->sets.dropped, quality.size() - kMaxImageLinePairs);
  std::sort(quality.begin(), quality.end(), std::greater<>());
  std::vector<float> kept;
  for (const ImageLinePair& pair : all->sets.pairs) kept.push_back(pair.quality);
  std::sort(kept.begin(), kept.end(), std::greater<>());
  quality.resize(kMaxImageLinePairs);
  EXPECT_EQ(kept, quality);
}

// Disparities drawn from the line's own covariance: the spread of depth and direction is what the
// sigmas say.
TEST(Sigmas, AgreeWithMonteCarlo) {
  Random random(5);
  const RectifiedCamera camera = testing::TestCamera();
  for (int k = 0; k < Cases(60); ++k) {
    Line3 line = AnyLine(random, camera);
    if (std::abs(line.a.z() - line.b.z()) > 0.2F) continue;  // first-order formulas, taken at the middle
    line.var_a = static_cast<float>(random.Uniform(0.01, 0.05));
    line.var_b = static_cast<float>(random.Uniform(0.01, 0.05));
    line.cov_ab = static_cast<float>(random.Uniform(-0.5, 0.5)) * std::sqrt(line.var_a * line.var_b);
    const double sa = std::sqrt(static_cast<double>(line.var_a));
    const double c = static_cast<double>(line.cov_ab) / sa;
    const double sb = std::sqrt(static_cast<double>(line.var_b) - c * c);
    double depth_square = 0, angle_square = 0;
    constexpr int kDraws = 2000;
    const Vector3d true_direction = (line.b - line.a).cast<double>().normalized();
    const double true_depth = 0.5 * static_cast<double>(line.a.z() + line.b.z());
    for (int i = 0; i < kDraws; ++i) {
      const double ga = testing::Gaussian(random), gb = testing::Gaussian(random);
      const auto at = [&](const Vector2& p, double d) {
        return camera.Triangulate(static_cast<double>(p.x()), static_cast<double>(p.y()), d);
      };
      const Vector3d a = at(line.segment.a, static_cast<double>(line.disparity_a_px) + sa * ga);
      const Vector3d b = at(line.segment.b, static_cast<double>(line.disparity_b_px) + c * ga + sb * gb);
      depth_square += std::pow(0.5 * (a.z() + b.z()) - true_depth, 2);
      angle_square += (b - a).normalized().cross(true_direction).squaredNorm();
    }
    const double depth_sigma = std::sqrt(depth_square / kDraws), angle_sigma = std::sqrt(angle_square / kDraws);
    EXPECT_NEAR(static_cast<double>(DepthSigma(camera, line)) / depth_sigma, 1, 0.15);
    // An upper bound: the part of the change that lies along the line turns nothing.
    EXPECT_GT(static_cast<double>(DirectionSigma(camera, line)), 0.8 * angle_sigma);
    EXPECT_LT(static_cast<double>(DirectionSigma(camera, line)), 1.6);
  }
}

}  // namespace
}  // namespace wirepose
