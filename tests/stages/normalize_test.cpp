// Local normalisation against the formula in double precision.
#include "stages/normalize.h"

#include <gtest/gtest.h>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::GrayImage;
using testing::Paint;

std::unique_ptr<NormalizedPlane> Normalize(const GrayImage& image) {
  auto out = std::make_unique<NormalizedPlane>();
  NormalizeLocally(image.view(), *out);
  return out;
}

int At(const NormalizedPlane& plane, int x, int y) { return plane[static_cast<std::size_t>(y * kMaxImageWidth + x)]; }

GrayImage Textured(double gain, double offset, double scale = 6) {
  return Paint(160, 120, [=](int x, int y) { return offset + gain * 90 * testing::Texture(x, y, scale, 5); });
}

// 128 + 48 (I - mean) / (deviation + 4) over the 14 x 14 pixels around the pixel's block of 2 x 2, borders repeated.
double ByFormula(const GrayImage& image, int x, int y) {
  double sum = 0, square = 0;
  for (int row = y / 2 * 2 - 6; row < y / 2 * 2 + 8; ++row) {
    for (int column = x / 2 * 2 - 6; column < x / 2 * 2 + 8; ++column) {
      const double v = image.view()(std::clamp(column, 0, image.width - 1), std::clamp(row, 0, image.height - 1));
      sum += v;
      square += v * v;
    }
  }
  const double mean = sum / 196;
  const double deviation = std::sqrt(std::max(0.0, square / 196 - mean * mean));
  return std::clamp(128 + 48 * (image.view()(x, y) - mean) / (deviation + 4), 0.0, 255.0);
}

TEST(Normalization, AgreesWithTheFormula) {
  testing::Random random(1);
  const GrayImage noise = Paint(101, 67, [&](int, int) { return random.Uniform(-40, 300); });
  for (const GrayImage& image : {noise, Textured(1, 128), Textured(0.1, 40)}) {
    const auto plane = Normalize(image);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x)
        ASSERT_NEAR(At(*plane, x, y), ByFormula(image, x, y), 0.51 + 0.01) << x << " " << y;
    }
  }
}

TEST(Normalization, OffsetCancels) {
  const auto a = Normalize(Textured(0.7, 100)), b = Normalize(Textured(0.7, 140));
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) ASSERT_NEAR(At(*a, x, y), At(*b, x, y), 1);
  }
}

// Up to the noise floor of 4 grey levels, which weakens low contrast.
TEST(Normalization, GainCancels) {
  const auto a = Normalize(Textured(1, 128)), b = Normalize(Textured(0.66, 90));
  double difference = 0, contrast = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      difference += std::abs(At(*a, x, y) - At(*b, x, y));
      contrast += std::abs(At(*a, x, y) - 128);
    }
  }
  EXPECT_LT(difference, 0.12 * contrast);
}

TEST(Normalization, FlatAreasStayFlat) {
  testing::Random random(2);
  const auto noisy = Normalize(Paint(160, 120, [&](int, int) { return 100 + 0.7 * testing::Gaussian(random); }));
  double sum = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) sum += std::abs(At(*noisy, x, y) - 128);
  }
  EXPECT_LT(sum / (160 * 120), 10);
  const auto flat = Normalize(Paint(64, 64, [](int, int) { return 255; }));
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) ASSERT_EQ(At(*flat, x, y), 128);
  }
}

}  // namespace
}  // namespace wirepose
