// Hash noise for procedural surfaces. Used inside this room only.
#ifndef WIREPOSE_SIM_NOISE_H_
#define WIREPOSE_SIM_NOISE_H_

#include <cmath>
#include <cstdint>

namespace wirepose::sim {

// A 32 bit integer hash (Wellons' lowbias32): cheap enough for several calls a sample.
constexpr std::uint32_t Hash(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7FEB352DU;
  x = (x ^ (x >> 15)) * 0x846CA68BU;
  return x ^ (x >> 16);
}

// A number in [0, 1) for a cell of a grid.
inline float HashUnit(int x, int y, std::uint32_t seed) {
  const std::uint32_t h =
      Hash(static_cast<std::uint32_t>(x) * 0x9E3779B1U ^ Hash(static_cast<std::uint32_t>(y) + seed * 0x85EBCA6BU));
  return static_cast<float>(h >> 8) * 0x1.0p-24F;
}

inline int Floor(float x) { return static_cast<int>(std::floor(x)); }
inline float Fraction(float x) { return x - std::floor(x); }
inline float Lerp(float a, float b, float t) { return a + (b - a) * t; }
inline float Smooth(float t) { return t * t * (3.0F - 2.0F * t); }

// Smooth noise in [-1, 1] with features one unit wide.
inline float ValueNoise(float x, float y, std::uint32_t seed) {
  const int ix = Floor(x), iy = Floor(y);
  const float tx = Smooth(x - static_cast<float>(ix)), ty = Smooth(y - static_cast<float>(iy));
  const float low = Lerp(HashUnit(ix, iy, seed), HashUnit(ix + 1, iy, seed), tx);
  const float high = Lerp(HashUnit(ix, iy + 1, seed), HashUnit(ix + 1, iy + 1, seed), tx);
  return 2.0F * Lerp(low, high, ty) - 1.0F;
}

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_NOISE_H_
