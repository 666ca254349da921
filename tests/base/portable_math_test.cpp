#include "base/portable_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace wirepose {
namespace {

// Distance of `value` from the true result in units of the last place of a float at `truth`.
double Ulps(float value, double truth) {
  int exponent = 0;
  (void)std::frexp(truth, &exponent);
  const double unit = std::ldexp(1.0, std::max(exponent - 24, -149));
  return std::abs(static_cast<double>(value) - truth) / unit;
}

// Every binade, dense in each; the oracle is the C library's double function.
TEST(PortableMath, LogIsNearlyCorrectlyRounded) {
  std::mt19937 random(3);
  double worst = 0;
  for (std::uint32_t binade = 0; binade < 255; ++binade) {
    for (int i = 0; i < 2000; ++i) {
      const std::uint32_t bits = binade << 23 | (random() & 0x007FFFFFU);
      if (bits == 0) continue;
      const auto x = std::bit_cast<float>(bits);
      worst = std::max(worst, Ulps(Log(x), std::log(static_cast<double>(x))));
    }
  }
  for (std::uint32_t bits = 0x3F7F0000U; bits < 0x3F810000U; ++bits) {  // around 1, where the result is small
    const auto x = std::bit_cast<float>(bits);
    worst = std::max(worst, Ulps(Log(x), std::log(static_cast<double>(x))));
  }
  EXPECT_LT(worst, 0.501);
}

TEST(PortableMath, ExpIsNearlyCorrectlyRounded) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(-103.9F, 88.72F), small(-1, 1), tiny(-1e-6F, 1e-6F);
  double worst = 0;
  for (int i = 0; i < 300000; ++i) {
    for (const float x : {any(random), small(random), tiny(random)}) {
      worst = std::max(worst, Ulps(Exp(x), std::exp(static_cast<double>(x))));
    }
  }
  EXPECT_LT(worst, 0.501);
}

TEST(PortableMath, Limits) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(Log(1), 0);
  EXPECT_EQ(Log(0), -kInfinity);
  EXPECT_EQ(Log(-0.0F), -kInfinity);
  EXPECT_EQ(Log(kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(Log(-1)) && std::isnan(Log(kNan)));
  EXPECT_FLOAT_EQ(Log(1e-45F), -103.27893F);
  EXPECT_EQ(Exp(0), 1);
  EXPECT_EQ(Exp(kInfinity), kInfinity);
  EXPECT_EQ(Exp(89), kInfinity);
  EXPECT_EQ(Exp(-104), 0);
  EXPECT_EQ(Exp(-kInfinity), 0);
  EXPECT_TRUE(std::isnan(Exp(kNan)));
  EXPECT_LT(Exp(88.722F), kInfinity);
  EXPECT_GT(Exp(-103.2F), 0);
}

// The bits themselves, so that a compiler that contracts, reorders or flushes shows here by name.
TEST(PortableMath, Bits) {
  std::uint32_t hash = 2166136261U;
  const auto add = [&](float value) { hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 16777619U; };
  for (std::uint32_t i = 1; i < 0x7F800000U; i += 65537) add(Log(std::bit_cast<float>(i)));
  for (int i = -104000; i < 89000; i += 7) add(Exp(static_cast<float>(i) * 0.001F));
  EXPECT_EQ(hash, 2755721462U);
}

}  // namespace
}  // namespace wirepose
