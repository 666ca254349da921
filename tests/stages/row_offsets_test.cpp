// Row offsets of pairs that are painted by formula: the right image is the left one moved by an exact disparity and an
// exact number of rows.
#include "stages/row_offsets.h"

#include <gtest/gtest.h>

#include <vector>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::Paint;
using testing::Planes;
using testing::Random;
using testing::Step;

constexpr int kWidth = 480, kHeight = 320;
using Picture = std::function<double(double, double)>;

// Printed cards, turned, on a fine texture.
Picture Cards(Random& random) {
  struct Card {
    double x, y, cosine, sine, half_width, half_height, contrast;
  };
  std::vector<Card> cards;
  for (int i = 0; i < 24; ++i) {
    const double angle = random.Uniform(0, M_PI);
    cards.push_back({30 + 75.0 * (i % 6) + random.Uniform(0, 40), 30 + 80.0 * (i / 6) + random.Uniform(0, 30),
                     std::cos(angle), std::sin(angle), random.Uniform(12, 30), random.Uniform(12, 30),
                     random.Uniform(-70, 70)});
  }
  return [cards](double u, double v) {
    double level = 110 + 8 * testing::Texture(u, v, 7, 5);
    for (const Card& c : cards) {
      if (std::abs(u - c.x) > 50 || std::abs(v - c.y) > 50) continue;  // out of its reach
      const double a = c.cosine * (u - c.x) + c.sine * (v - c.y), b = c.cosine * (v - c.y) - c.sine * (u - c.x);
      level += c.contrast * Step(c.half_width - std::abs(a)) * Step(c.half_height - std::abs(b));
    }
    return level;
  };
}

class RowOffsetsTest : public ::testing::Test {
 protected:
  // The right eye is darker, has more contrast, and noise of its own.
  void See(const Picture& left, const Picture& right, double noise) {
    left_ = testing::FindAll(
        Paint(kWidth, kHeight, [&](int x, int y) { return left(x, y) + noise * testing::Gaussian(random_); }));
    right_ = testing::FindAll(Paint(
        kWidth, kHeight, [&](int x, int y) { return 10 + 0.75 * right(x, y) + noise * testing::Gaussian(random_); }));
    FindCorners({}, left_->smooth, kWidth, kHeight, left_->segments, corners_);
    Measure();
  }
  void Measure() {
    MeasureRowOffsets({},
                      {kWidth, kHeight, left_->normalized, right_->normalized, left_->smooth, right_->smooth,
                       *left_map_, *right_map_},
                      corners_, *scratch_, offsets_);
  }
  // The same picture seen by both, `disparity` to the left and `rows` down.
  void SeeMoved(double disparity, double rows, double noise) {
    const Picture cards = Cards(random_);
    See(
        cards, [&](double u, double v) { return cards(u + disparity, v - rows); }, noise);
  }

  Random random_{7};
  std::unique_ptr<RectificationMap> left_map_ = testing::WholeImage(kWidth, kHeight);
  std::unique_ptr<RectificationMap> right_map_ = testing::WholeImage(kWidth, kHeight);
  std::unique_ptr<Planes> left_, right_;
  std::unique_ptr<RowOffsetScratch> scratch_ = std::make_unique<RowOffsetScratch>();
  Corners corners_;
  RowOffsets offsets_;
};

TEST_F(RowOffsetsTest, FindsTheRowsThatTheRightEyeIsOff) {
  std::size_t found = 0, good = 0;
  double sum = 0, square = 0;
  for (const double rows : {0.0, 0.3, -0.5, 1.75, -3.2, 6.4}) {
    for (const double disparity : {5.3, 41.0, 90.6}) {
      SCOPED_TRACE(::testing::Message() << rows << " rows, disparity " << disparity);
      SeeMoved(disparity, rows, 1.5);
      EXPECT_GE(offsets_.size(), 8u);
      for (const RowOffset& o : offsets_) {
        ++found;
        const double error = static_cast<double>(o.offset_px) - rows;
        if (std::abs(error) > 0.3 || std::abs(static_cast<double>(o.disparity_px) - disparity) > 0.3) continue;
        ++good;
        sum += error;
        square += error * error;
      }
    }
  }
  const auto n = static_cast<double>(good);
  std::printf("%zu of %zu corners within 0.3 px, mean error %.3f px, rms %.3f px\n", good, found, sum / n,
              std::sqrt(square / n));
  EXPECT_GE(n, 0.97 * static_cast<double>(found));
  EXPECT_LT(std::abs(sum / n), 0.01) << "the error leans to one side";
  EXPECT_LT(std::sqrt(square / n), 0.08);
}

// What lies beyond the search is left out rather than found at its border.
TEST_F(RowOffsetsTest, RowsBeyondReachGiveNoCorners) {
  SeeMoved(30, kRowOffsetReach + 4, 1.5);
  EXPECT_GT(corners_.size(), 8u);
  EXPECT_LE(offsets_.size(), 2u);
}

TEST_F(RowOffsetsTest, ImagesWithoutCornersGiveNone) {
  See([](double, double) { return 90.0; }, [](double, double) { return 90.0; }, 2);
  EXPECT_TRUE(corners_.empty());
  const Picture stripes = [](double u, double v) { return 100 + 60 * Step(8 - std::fmod(u + 0.5 * v + 1000, 16.0)); };
  See(
      stripes, [&](double u, double v) { return stripes(u + 20, v); }, 1);
  EXPECT_LE(offsets_.size(), 2u) << "an edge without end looks the same everywhere along it";
}

// Tiles all alike: no place is better than the next tile's.
TEST_F(RowOffsetsTest, RepeatedPatternsAreNotTrusted) {
  const Picture tiles = [](double u, double v) {
    return 150 - 60 * (1 - Step(2 - std::fmod(u + 960, 24.0)) * Step(2 - std::fmod(v + 960, 24.0)));
  };
  See(
      tiles, [&](double u, double v) { return tiles(u + 31, v); }, 1.5);
  EXPECT_LE(offsets_.size(), 2u);
}

TEST_F(RowOffsetsTest, OneCornerACellAndOnlyWhereBothEyesSee) {
  SeeMoved(40, 0, 1.5);
  std::array<int, kMaxRowOffsets> count{};
  for (const Corner& c : corners_) {
    ++count[static_cast<std::size_t>(c.y * kRowOffsetCellsY / kHeight * kRowOffsetCellsX +
                                     c.x * kRowOffsetCellsX / kWidth)];
  }
  for (const int n : count) EXPECT_LE(n, 1);
  const std::size_t all = offsets_.size();
  for (RectificationMap::Interval& valid : right_map_->valid) valid.begin = kWidth / 2;
  Measure();
  EXPECT_LT(offsets_.size(), all);
  for (const RowOffset& o : offsets_) EXPECT_GE(o.x_px - o.disparity_px, kWidth / 2);
  for (RectificationMap::Interval& valid : left_map_->valid) valid = {};
  Measure();
  EXPECT_TRUE(offsets_.empty());
}

}  // namespace
}  // namespace wirepose
