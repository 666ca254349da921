// Logarithm and exponential with the same bits on every target: + - * / and bit patterns only.
#ifndef WIREPOSE_BASE_PORTABLE_MATH_H_
#define WIREPOSE_BASE_PORTABLE_MATH_H_

#include <bit>
#include <cstdint>
#include <limits>

namespace wirepose {

// The C libraries' functions differ in the last bit between targets and releases; IEEE 754 defines the results of
// + - * / and sqrt only. Both functions compute in double, so that the rounding to float is nearly always the right
// one (tests/base/portable_math_test.cpp: within 0.501 units in the last place). O(1), any thread.

// Natural logarithm. 0 gives -infinity, infinity itself, a negative number or NaN gives NaN.
// With x = 2^e m, m in [sqrt(1/2), sqrt(2)): e ln 2 + 2 artanh((m - 1) / (m + 1)), whose series is cut at 1e-12.
inline float Log(float x) {
  if (!(x > 0)) return x == 0 ? -std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
  if (x > std::numeric_limits<float>::max()) return x;
  std::int32_t exponent = 0;
  if (x < std::numeric_limits<float>::min()) {  // subnormal
    x *= 8388608.0F;
    exponent = -23;
  }
  const auto bits = std::bit_cast<std::uint32_t>(x);
  exponent += static_cast<std::int32_t>(bits >> 23) - 127;
  double m = static_cast<double>(std::bit_cast<float>((bits & 0x007FFFFFU) | 0x3F800000U));
  if (m > 1.4142135623730951) {
    m *= 0.5;
    ++exponent;
  }
  const double s = (m - 1) / (m + 1);
  const double q = s * s;
  const double series =
      1 + q * (1.0 / 3 + q * (1.0 / 5 + q * (1.0 / 7 + q * (1.0 / 9 + q * (1.0 / 11 + q * (1.0 / 13))))));
  return static_cast<float>(exponent * 0.69314718055994531 + 2 * s * series);
}

// Natural exponential. Above 88.73 infinity, below -103.98 zero, NaN for NaN.
// With x = k ln 2 + r, |r| <= ln 2 / 2: 2^k exp(r), whose series is cut at 1e-11.
inline float Exp(float x) {
  if (x != x) return x;
  if (x > 88.73F) return std::numeric_limits<float>::infinity();
  if (x < -103.98F) return 0;
  const double scaled = static_cast<double>(x) * 1.4426950408889634;
  const auto k = static_cast<std::int32_t>(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
  const double r = static_cast<double>(x) - k * 0.69314718055994531;
  double series = 1;
  for (int n = 9; n > 0; --n) series = 1 + r * series / n;
  return static_cast<float>(series * std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52));
}

}  // namespace wirepose

#endif  // WIREPOSE_BASE_PORTABLE_MATH_H_
