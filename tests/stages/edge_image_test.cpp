// Smoothing against OpenCV, gradient against double precision, ridges against edges whose place is
// known.
#include "stages/edge_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <set>
#include <vector>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::GrayImage;
using testing::Paint;
using testing::Random;

GrayImage Noise(int width, int height, double mean, double sigma, std::uint64_t seed) {
  Random random(seed);
  return Paint(width, height, [&](int, int) { return mean + sigma * testing::Gaussian(random); });
}

struct Ridges {
  SmoothPlane smooth;
  EdgeImage image;
};

std::unique_ptr<Ridges> Find(const GrayImage& image, const RectificationMap& map) {
  auto out = std::make_unique<Ridges>();
  SmoothImage(image.view(), out->smooth);
  FindRidges(out->smooth, image.width, image.height, map, {}, out->image);
  return out;
}

std::unique_ptr<Ridges> Find(const GrayImage& image) {
  return Find(image, *testing::WholeImage(image.width, image.height));
}

// The 5 x 5 binomial filter without any rounding, times 256.
cv::Mat Binomial(const GrayImage& image) {
  const cv::Mat kernel = (cv::Mat_<float>(1, 5) << 1, 4, 6, 4, 1);
  cv::Mat out;
  cv::sepFilter2D(cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())), out,
                  CV_32F, kernel, kernel, {-1, -1}, 0, cv::BORDER_REPLICATE);
  return out;
}

TEST(Smoothing, EqualsTheBinomialFilter) {
  for (const auto& [width, height] : {std::pair(640, 480), {64, 64}, {101, 67}, {640, 5}}) {
    const GrayImage image = Noise(width, height, 128, 80, 3);
    const auto smooth = std::make_unique<SmoothPlane>();
    SmoothImage(image.view(), *smooth);
    const cv::Mat expected = Binomial(image);
    int wrong = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int rounded = (static_cast<int>(expected.at<float>(y, x)) + 8) / 16;
        if ((*smooth)[EdgeImage::Index(x, y)] != rounded) ++wrong;
      }
    }
    EXPECT_EQ(wrong, 0) << width << "x" << height;
  }
}

// Rounding of the smoothed values is all that may differ: half a unit each.
TEST(Gradient, AgreesWithDoublePrecision) {
  const GrayImage image = Noise(320, 200, 128, 60, 4);
  const auto ridges = Find(image);
  const cv::Mat exact = Binomial(image);
  for (int y = 1; y < 199; ++y) {
    for (int x = 1; x < 319; ++x) {
      const double gx =
          (static_cast<double>(exact.at<float>(y, x + 1)) - static_cast<double>(exact.at<float>(y, x - 1))) / 16;
      const double gy =
          (static_cast<double>(exact.at<float>(y + 1, x)) - static_cast<double>(exact.at<float>(y - 1, x))) / 16;
      const std::size_t i = EdgeImage::Index(x, y);
      ASSERT_NEAR(ridges->image.gx[i], gx, 1);
      ASSERT_NEAR(ridges->image.gy[i], gy, 1);
      ASSERT_NEAR(ridges->image.magnitude[i], std::hypot(gx, gy), 2.5);
    }
  }
}

TEST(Gradient, UnitIsGreyLevelsPerPixel) {
  const auto ridges = Find(Paint(200, 100, [](int x, int y) { return 20 + 0.5 * x + y; }));
  const std::size_t i = EdgeImage::Index(100, 50);
  EXPECT_NEAR(static_cast<double>(ridges->image.gx[i]) / kGradientOne, 0.5, 0.1);
  EXPECT_NEAR(static_cast<double>(ridges->image.gy[i]) / kGradientOne, 1, 0.1);
}

// Every row or column that the edge crosses shows one ridge pixel, on the edge, with the gradient
// towards the light.
TEST(RidgeFinding, StepEdgeAtEveryAngle) {
  Random random(5);
  for (int k = 0; k < Cases(180); ++k) {
    const double angle = k * 2 * M_PI / Cases(180) + random.Uniform(0, 0.03), offset = random.Uniform(-20, 20);
    const double nx = std::cos(angle), ny = std::sin(angle);
    const auto distance = [&](double x, double y) { return nx * (x - 80) + ny * (y - 80) - offset; };
    const auto ridges = Find(Paint(160, 160, [&](int x, int y) { return 60 + 80 * testing::Step(distance(x, y)); }));
    const EdgeImage& e = ridges->image;
    std::set<int> crossed;
    for (std::uint32_t r = 0; r < e.ridge_count; ++r) {
      const int x = static_cast<int>(e.ridge_pixels[r] % kMaxImageWidth),
                y = static_cast<int>(e.ridge_pixels[r] / kMaxImageWidth);
      ASSERT_LT(std::abs(distance(x, y)), 1.1) << angle;
      ASSERT_GT(nx * e.gx[e.ridge_pixels[r]] + ny * e.gy[e.ridge_pixels[r]], 0);
      crossed.insert(std::abs(nx) > std::abs(ny) ? y : x);
    }
    // Rows (or columns) in which the edge is inside by more than the border.
    int expected = 0;
    for (int c = 3; c < 157; ++c) {
      const double other =
          std::abs(nx) > std::abs(ny) ? 80 + (offset - ny * (c - 80)) / nx : 80 + (offset - nx * (c - 80)) / ny;
      if (other < 4 || other > 155) continue;
      ++expected;
      EXPECT_TRUE(crossed.contains(c)) << angle << " " << c;
    }
    EXPECT_GT(expected, 50);
    EXPECT_LE(e.ridge_count, static_cast<std::uint32_t>(1.15 * expected) + 8);
  }
}

TEST(RidgeFinding, NoiseAloneGivesFew) {
  for (const double sigma : {0.0, 1.0, 3.0, 6.0}) {
    const auto ridges = Find(Noise(320, 240, 120, sigma, 6));
    EXPECT_LT(ridges->image.ridge_count, 320 * 240 / 12) << sigma;
  }
}

TEST(RidgeFinding, FlatImageGivesNone) {
  for (const int level : {0, 77, 255})
    EXPECT_EQ(Find(Paint(100, 80, [=](int, int) { return level; }))->image.ridge_count, 0U);
}

TEST(RidgeFinding, StaysAwayFromWhatTheLensDidNotSee) {
  auto map = testing::WholeImage(200, 100);
  for (int y = 0; y < 100; ++y)
    map->valid[static_cast<std::size_t>(y)] = {static_cast<std::int16_t>(y), static_cast<std::int16_t>(200 - y)};
  const auto ridges = Find(Noise(200, 100, 128, 60, 7), *map);
  EXPECT_GT(ridges->image.ridge_count, 300U);
  for (std::uint32_t r = 0; r < ridges->image.ridge_count; ++r) {
    const int x = static_cast<int>(ridges->image.ridge_pixels[r] % kMaxImageWidth);
    const int y = static_cast<int>(ridges->image.ridge_pixels[r] / kMaxImageWidth);
    EXPECT_TRUE(y >= 3 && y < 97 && x >= y + 3 && x < 200 - y - 3) << x << " " << y;
  }
}

// More ridges than fit: the strongest stay, the list is sorted, what was dropped is counted and
// unmarked.
TEST(RidgeFinding, OverflowKeepsTheStrongest) {
  const auto ridges =
      Find(Paint(640, 480, [](int x, int y) { return 128 + (x % 4 < 2 ? 1 : -1) * (20 + 0.1 * x + 0.1 * (y % 64)); }));
  EdgeImage& e = ridges->image;
  ASSERT_EQ(e.ridge_count, kMaxRidgePixels);
  EXPECT_GT(e.ridge_dropped, 0U);
  std::uint32_t marked = 0;
  int strongest_unmarked = 0;
  for (int y = 3; y < 477; ++y) {
    for (int x = 3; x < 637; ++x) {
      const std::size_t i = EdgeImage::Index(x, y);
      if (e.ridge[i] != 0) {
        ++marked;
      } else if (e.magnitude[i] > e.magnitude[i - 1] && e.magnitude[i] >= e.magnitude[i + 1]) {
        strongest_unmarked = std::max(strongest_unmarked, int{e.magnitude[i]});
      }
    }
  }
  EXPECT_EQ(marked, e.ridge_count);
  SortRidges(e);
  const std::vector<std::uint32_t> rows(e.ridge_pixels.begin(), e.ridge_pixels.begin() + e.ridge_count);
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
  // In steps of half a grey level per pixel, those of one step in the order of rows.
  std::vector<std::uint32_t> expected = rows;
  std::stable_sort(expected.begin(), expected.end(),
                   [&](std::uint32_t p, std::uint32_t q) { return e.magnitude[p] / 16 > e.magnitude[q] / 16; });
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), e.by_magnitude.begin()));
  EXPECT_LE(strongest_unmarked, e.magnitude[expected.back()] + 16);
}

}  // namespace
}  // namespace wirepose
