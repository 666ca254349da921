// The vectors against bilinear interpolation in double precision, one value at a time.
#include "stages/edge_profile.h"

#include <gtest/gtest.h>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;

class EdgeProfileTest : public ::testing::Test {
 protected:
  static constexpr int kWidth = 640, kHeight = 480;

  // Smooth enough that rounding of a position changes little: a sum of waves.
  void SetUp() override {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        (*plane_)[EdgeImage::Index(x, y)] = static_cast<std::int16_t>(
            std::floor(2040 + 1000 * std::sin(0.9 * x + 0.2 * y) + 1000 * std::sin(0.7 * y - 0.3 * x)));
      }
    }
  }

  [[nodiscard]] double At(double x, double y) const {
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const double u = x - i, v = y - j;
    const auto value = [&](int a, int b) { return static_cast<double>((*plane_)[EdgeImage::Index(i + a, j + b)]); };
    return (1 - v) * ((1 - u) * value(0, 0) + u * value(1, 0)) + v * ((1 - u) * value(0, 1) + u * value(1, 1));
  }

  // The central difference one pixel before and after `offset` along the normal.
  [[nodiscard]] double Gradient(const Vector2& p, const Vector2& n, int offset) const {
    const auto value = [&](int k) {
      return At(static_cast<double>(p.x()) + k * static_cast<double>(n.x()),
                static_cast<double>(p.y()) + k * static_cast<double>(n.y()));
    };
    return value(offset + 1) - value(offset - 1);
  }

  std::unique_ptr<SmoothPlane> plane_ = std::make_unique<SmoothPlane>();
};

TEST_F(EdgeProfileTest, AgreesWithBilinearInterpolation) {
  Random random(1);
  EdgeProfile profile;
  int read = 0;
  for (int k = 0; k < Cases(3000); ++k) {
    const double angle = random.Uniform(0, 2 * M_PI);
    const Vector2 n(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
    const Vector2 p(static_cast<float>(random.Uniform(0, kWidth)), static_cast<float>(random.Uniform(0, kHeight)));
    const int range = 1 + k % EdgeProfile::kMaxRange;
    const float reach = static_cast<float>(range) + 2;
    const bool inside = p.x() - reach * std::abs(n.x()) >= 0 && p.x() + reach * std::abs(n.x()) < kWidth - 1 &&
                        p.y() - reach * std::abs(n.y()) >= 0 && p.y() + reach * std::abs(n.y()) < kHeight - 1;
    ASSERT_EQ(profile.Read(*plane_, kWidth, kHeight, p, n, range), inside);
    if (!inside) continue;
    ++read;
    // A position near 640 is rounded to 3e-5 px, and the image changes by up to 1,700 a pixel.
    for (int offset = -range; offset <= range; ++offset)
      ASSERT_NEAR(profile.GradientAt(offset), Gradient(p, n, offset), 0.5) << range << " " << offset;
    std::vector<int> peaks;
    profile.ForEachPeak(500, [&](const EdgePeak& peak) {
      peaks.push_back(static_cast<int>(std::floor(peak.offset_px + 0.5F)));
      EXPECT_LE(std::abs(peak.offset_px), static_cast<float>(range) + 0.5F);
      EXPECT_GE(std::abs(peak.gradient), 500);
    });
    EXPECT_TRUE(std::is_sorted(peaks.begin(), peaks.end()));
    int expected = 0;
    for (int offset = -range; offset <= range; ++offset) {
      const auto magnitude = [&](int at) { return std::abs(profile.GradientAt(at)); };
      const float here = magnitude(offset);
      expected += here >= 500 && here >= magnitude(offset - 1) && here > magnitude(offset + 1) ? 1 : 0;
    }
    EXPECT_EQ(static_cast<int>(peaks.size()), expected);
  }
  EXPECT_GT(read, Cases(3000) / 2);
}

// A step between two pixels is found there, whichever way the profile crosses it.
TEST_F(EdgeProfileTest, FindsAStepToAFractionOfAPixel) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      (*plane_)[EdgeImage::Index(x, y)] =
          static_cast<std::int16_t>(1600 + std::floor(1600 * testing::Step(x - 300.3, 1.2)));
    }
  }
  EdgeProfile profile;
  for (const float sign : {1.0F, -1.0F}) {
    for (const float start : {297.0F, 299.4F, 303.0F}) {
      ASSERT_TRUE(profile.Read(*plane_, kWidth, kHeight, {start, 200.5F}, {sign, 0}, 6));
      int found = 0;
      profile.ForEachPeak(100, [&](const EdgePeak& peak) {
        ++found;
        EXPECT_NEAR(start + sign * peak.offset_px, 300.3F, 0.1F);
        EXPECT_GT(sign * peak.gradient, 0);
      });
      EXPECT_EQ(found, 1);
    }
  }
}

}  // namespace
}  // namespace wirepose
