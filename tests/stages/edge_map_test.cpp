// The edge map against a search through all ridge pixels.
#include "stages/edge_map.h"

#include <gtest/gtest.h>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;

// The sector of 11.25 degrees by trigonometry.
int SectorByAngle(double dx, double dy) {
  double angle = std::atan2(dy, dx);
  if (angle < 0) angle += M_PI;
  return static_cast<int>(angle / (M_PI / EdgeMap::kDirections)) % EdgeMap::kDirections;
}

double DistanceToBorder(double dx, double dy) {
  const double s = std::atan2(dy, dx) / (M_PI / EdgeMap::kDirections);
  return std::abs(s - std::round(s));
}

TEST(EdgeDirection, AgreesWithTheAngle) {
  Random random(1);
  for (int i = 0; i < 100000; ++i) {
    const double angle = random.Uniform(-M_PI, M_PI), length = std::pow(10.0, random.Uniform(-3, 4));
    const double dx = length * std::cos(angle), dy = length * std::sin(angle);
    if (DistanceToBorder(dx, dy) < 1e-4) continue;
    ASSERT_EQ(EdgeMap::Direction(static_cast<float>(dx), static_cast<float>(dy)), SectorByAngle(dx, dy)) << angle;
  }
}

TEST(EdgeDirection, HalfATurnChangesNothing) {
  Random random(2);
  for (int i = 0; i < 10000; ++i) {
    const auto dx = static_cast<float>(random.Uniform(-1, 1)), dy = static_cast<float>(random.Uniform(-1, 1));
    ASSERT_EQ(EdgeMap::Direction(dx, dy), EdgeMap::Direction(-dx, -dy));
  }
}

// Axes and diagonals lie on borders of sectors: either neighbour will do, since look-ups have a
// tolerance of one.
TEST(EdgeDirection, AxesAreInRange) {
  for (const auto& [dx, dy] : {std::pair(1, 0), {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {0, 0}}) {
    const int d = EdgeMap::Direction(static_cast<float>(dx), static_cast<float>(dy));
    EXPECT_GE(d, 0);
    EXPECT_LT(d, EdgeMap::kDirections);
  }
}

struct RandomRidges {
  EdgeImage edges;
  EdgeMap map;
};

std::unique_ptr<RandomRidges> Build(std::uint64_t seed, int width, int height, int count) {
  Random random(seed);
  auto out = std::make_unique<RandomRidges>();
  out->edges.width = width;
  out->edges.height = height;
  for (int i = 0; i < count; ++i) {
    const std::size_t at = EdgeImage::Index(3 + random.Below(width - 6), 3 + random.Below(height - 6));
    out->edges.gx[at] = static_cast<std::int16_t>(random.Below(2001) - 1000);
    out->edges.gy[at] = static_cast<std::int16_t>(random.Below(2001) - 1000);
    out->edges.ridge_pixels[out->edges.ridge_count++] = static_cast<std::uint32_t>(at);
  }
  BuildEdgeMap(out->edges, out->map);
  return out;
}

// Is there a ridge pixel near that runs in this sector or the next one? Near: within dx^2 + dy^2 <=
// `square`.
bool FindByBruteForce(const EdgeImage& edges, int x, int y, int direction, int square) {
  for (std::uint32_t k = 0; k < edges.ridge_count; ++k) {
    const int dx = static_cast<int>(edges.ridge_pixels[k] % kMaxImageWidth) - x;
    const int dy = static_cast<int>(edges.ridge_pixels[k] / kMaxImageWidth) - y;
    if (dx * dx + dy * dy > square) continue;
    const std::uint32_t i = edges.ridge_pixels[k];
    const int own = EdgeMap::Direction(static_cast<float>(-edges.gy[i]), static_cast<float>(edges.gx[i]));
    const int turn = (direction - own + EdgeMap::kDirections) % EdgeMap::kDirections;
    if (turn <= 1 || turn == EdgeMap::kDirections - 1) return true;
  }
  return false;
}

// Cells are two pixels wide: what is found is what lies within the radius of the middle of the cell.
TEST(EdgeMapLookUp, AgreesWithBruteForce) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const auto r = Build(seed, 120, 90, 300);
    Random random(seed + 100);
    int hits = 0;
    for (int i = 0; i < Cases(10000); ++i) {
      const double x = random.Uniform(4, 115.49), y = random.Uniform(4, 85.49);
      const int direction = random.Below(EdgeMap::kDirections);
      const int u = 2 * static_cast<int>(std::floor(x / 2 + 0.5)), v = 2 * static_cast<int>(std::floor(y / 2 + 0.5));
      const bool found = r->map.HasEdge(static_cast<float>(x), static_cast<float>(y), direction);
      ASSERT_EQ(found, FindByBruteForce(r->edges, u, v, direction, 5));
      hits += found ? 1 : 0;
    }
    EXPECT_GT(hits, Cases(10000) / 20);
  }
}

TEST(EdgeMapLookUp, BackgroundIsTheRateOfRandomHits) {
  const auto r = Build(9, 400, 300, 4000);
  std::uint64_t set = 0;
  for (int y = 4; y < 296; ++y) {
    for (int x = 4; x < 396; ++x) {
      for (int d = 0; d < EdgeMap::kDirections; ++d)
        set += r->map.HasEdge(static_cast<float>(x), static_cast<float>(y), d) ? 1 : 0;
    }
  }
  EXPECT_NEAR(static_cast<double>(r->map.background), static_cast<double>(set) / (292.0 * 392 * EdgeMap::kDirections),
              0.005);
}

TEST(EdgeMapLookUp, NothingRemainsOfAnEarlierImage) {
  const auto r = Build(10, 200, 100, 3000);
  r->edges.ridge_count = 0;
  BuildEdgeMap(r->edges, r->map);
  EXPECT_EQ(r->map.background, 0);
  for (int j = 0; j < 50; ++j) {
    for (int i = 0; i < 100; ++i) ASSERT_EQ(r->map.directions[static_cast<std::size_t>(j * EdgeMap::kStride + i)], 0);
  }
}

TEST(EdgeMapLookUp, ContainsLeavesTheBorderOut) {
  const auto r = Build(11, 200, 100, 10);
  EXPECT_TRUE(r->map.Contains(4, 4));
  EXPECT_TRUE(r->map.Contains(195.9F, 95.9F));
  EXPECT_FALSE(r->map.Contains(3.9F, 50));
  EXPECT_FALSE(r->map.Contains(196, 50));
  EXPECT_FALSE(r->map.Contains(50, 96));
  EXPECT_FALSE(r->map.Contains(50, -1));
  EXPECT_FALSE(r->map.Contains(NAN, 50));
}

}  // namespace
}  // namespace wirepose
