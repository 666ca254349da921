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

// The photon transfer method of EMVA 1288: temporal variance against mean is a line whose slope is
// the overall gain and whose height at no light is the dark noise. Temporal variance from the
// difference of two images, so that the fixed pattern drops out.
struct PhotonTransfer {
  double gain = 0, dark_variance = 0;  // grey levels per electron; grey levels squared
};

PhotonTransfer Measure(const Sensor& sensor) {
  // Weighted least squares of variance = a + b mean; the variance's own error grows with it.
  double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  std::uint64_t seed = 100;
  for (const float level : {0.03F, 0.04F, 0.05F, 0.06F, 0.1F, 0.2F, 0.3F, 0.45F, 0.6F, 0.75F, 0.85F}) {
    for (int repeat = 0; repeat < 2; ++repeat) {
      const dataset::GrayImage a = Expose(Even(level), 1, sensor, ++seed), b = Expose(Even(level), 1, sensor, ++seed);
      double mean = 0, squares = 0;
      for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        mean += 0.5 * (a.pixels[i] + b.pixels[i]);
        squares += 0.5 * (a.pixels[i] - b.pixels[i]) * (a.pixels[i] - b.pixels[i]);
      }
      const auto n = static_cast<double>(a.pixels.size());
      const double x = mean / n, y = squares / n, w = 1 / (y * y);
      s += w;
      sx += w * x;
      sy += w * y;
      sxx += w * x * x;
      sxy += w * x * y;
    }
  }
  const double slope = (s * sxy - sx * sy) / (s * sxx - sx * sx);
  return {slope, (sy - slope * sx) / s - 1.0 / 12};  // less the rounding's share
}

TEST(Sensor, PhotonTransferCurveGivesGainAndReadNoiseBack) {
  for (const Sensor& sensor : {Sensor{.full_well_e = 4000, .read_noise_e = 12},
                               Sensor{.full_well_e = 1500, .read_noise_e = 8, .prnu = 0.01F, .dsnu_e = 3},
                               Sensor{.full_well_e = 9000, .read_noise_e = 30, .dark_e = 100, .prnu = 0.005F}}) {
    const PhotonTransfer found = Measure(sensor);
    EXPECT_NEAR(found.gain / double{sensor.OverallGain()}, 1, 0.03);
    // In the dark, read noise and the shot noise of the dark signal add up.
    const double dark_e = std::sqrt(double{sensor.read_noise_e * sensor.read_noise_e} + double{sensor.dark_e});
    EXPECT_NEAR(std::sqrt(found.dark_variance) / (dark_e * double{sensor.OverallGain()}), 1, 0.03);
  }
}

TEST(Sensor, FixedPatternStaysFromFrameToFrame) {
  const Sensor sensor{.full_well_e = 20000, .read_noise_e = 5, .prnu = 0.02F, .dsnu_e = 0};
  constexpr int kFrames = 24, kSide = 100;
  std::vector<double> sums(kSide * kSide);
  for (int f = 0; f < kFrames; ++f) {
    const dataset::GrayImage image = Expose(Even(0.5F, kSide), 1, sensor, 900U + static_cast<std::uint64_t>(f));
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += image.pixels[i] / double{kFrames};
  }
  double mean = 0, square = 0;
  for (const double p : sums) {
    mean += p / static_cast<double>(sums.size());
    square += p * p / static_cast<double>(sums.size());
  }
  // What is left of the temporal noise after averaging: shot, read and rounding.
  const double electrons = 10000, k = double{sensor.OverallGain()};
  const double rest = ((electrons + 25) * k * k + 1.0 / 12) / kFrames;
  EXPECT_NEAR(std::sqrt(square - mean * mean - rest) / (0.02 * mean), 1, 0.05);

  Sensor other = sensor;
  other.serial = 2;
  EXPECT_NE(Expose(Even(0.5F, kSide), 1, other, 900).pixels, Expose(Even(0.5F, kSide), 1, sensor, 900).pixels);
}

// With few electrons the numbers are Poisson's: mean and variance agree, and they are whole.
TEST(Sensor, FewPhotonsAreCounted) {
  const Sensor sensor{.full_well_e = 255, .read_noise_e = 0};  // one grey level an electron
  for (const float electrons : {0.5F, 3.0F, 20.0F, 55.0F}) {
    const Moments moments = MomentsOf(Expose(Even(electrons / 255), 1, sensor, 5));
    EXPECT_NEAR(moments.mean / double{electrons}, 1, 0.02);
    EXPECT_NEAR(moments.variance / double{electrons}, 1, 0.03);
  }
}

TEST(Sensor, GammaAndVeil) {
  const Sensor curved{.full_well_e = 0, .gamma = 2.2F};
  EXPECT_EQ(Expose(Even(0.25F, 1), 1, curved, 1).pixels[0], std::lround(255 * std::pow(0.25, 1 / 2.2)));
  EXPECT_EQ(Expose(Even(1, 1), 1, curved, 1).pixels[0], 255);
  RadianceImage image = Even(0, 10);
  for (std::size_t i = 0; i < 50; ++i) image.pixels[i] = 1;
  const Sensor veiled{.full_well_e = 0, .veil = 0.2F};
  EXPECT_EQ(Expose(image, 0.5F, veiled, 1).pixels[99], std::lround(255 * 0.5 * 0.2 * 0.5));
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
