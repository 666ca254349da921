#include "sim/sensor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace wirepose::sim {
namespace {

RadianceImage Even(float level, int side = 300) {
  return {side, side, std::vector<float>(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), level)};
}

struct Moments {
  double mean = 0, variance = 0;
};

Moments MomentsOf(const dataset::GrayImage& image) {
  double sum = 0, square = 0;
  for (const std::uint8_t p : image.pixels) {
    sum += p;
    square += double(p) * p;
  }
  const auto n = static_cast<double>(image.pixels.size());
  return {sum / n, square / n - sum / n * (sum / n)};
}

TEST(Sensor, WithoutNoiseGivesRoundedLevels) {
  const Sensor ideal{.gain = 0.5F, .full_well_e = 0};
  EXPECT_EQ(Expose(Even(0.4F, 1), 1, ideal, 1).pixels[0], 51);
  EXPECT_EQ(Expose(Even(0.4F, 1), 2, ideal, 1).pixels[0], 102);
  EXPECT_EQ(Expose(Even(9, 1), 1, ideal, 1).pixels[0], 255);
  EXPECT_EQ(Expose(Even(-1, 1), 1, ideal, 1).pixels[0], 0);
}

// Variance in electrons: signal (shot) + read noise squared; plus 1/12 grey level squared of
// rounding.
TEST(Sensor, NoiseHasTheModelsMoments) {
  const Sensor sensor{.gain = 1, .full_well_e = 8000, .read_noise_e = 20};
  for (const float level : {0.1F, 0.3F, 0.6F, 0.8F}) {
    const Moments moments = MomentsOf(Expose(Even(level), 1, sensor, 7));
    const double electrons = double{level} * 8000, grey_per_electron = 255.0 / 8000;
    const double expected = (electrons + 400) * grey_per_electron * grey_per_electron + 1.0 / 12;
    EXPECT_NEAR(moments.mean, 255 * double{level}, 0.05);
    EXPECT_NEAR(moments.variance / expected, 1, 0.03);
  }
}

TEST(Sensor, NoiseBelongsToTheSeed) {
  const Sensor sensor;
  EXPECT_EQ(Expose(Even(0.5F), 1, sensor, 1).pixels, Expose(Even(0.5F), 1, sensor, 1).pixels);
  EXPECT_NE(Expose(Even(0.5F), 1, sensor, 1).pixels, Expose(Even(0.5F), 1, sensor, 2).pixels);
}

TEST(Sensor, AutoExposureBringsTheBrightPixelsToTheTarget) {
  RadianceImage image = Even(0, 10);
  for (std::size_t i = 0; i < 100; ++i) image.pixels[(i * 37) % 100] = static_cast<float>(i) / 50;
  EXPECT_FLOAT_EQ(AutoExposure(image, 0.8F), 0.8F / (97.0F / 50));
  EXPECT_EQ(AutoExposure(Even(0, 10), 0.8F), 1);
}

}  // namespace
}  // namespace wirepose::sim
