// Random numbers as a pure function of (seed, where they are used): no shared engine, so that
// threads cannot change the outcome.
#ifndef WIREPOSE_SIM_RANDOM_H_
#define WIREPOSE_SIM_RANDOM_H_

#include <cmath>
#include <cstdint>

namespace wirepose::sim {

// SplitMix64's output function (Steele, Lea, Flood 2014): each input bit flips about half of the
// output bits.
constexpr std::uint64_t Mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

constexpr std::uint64_t Mix(std::uint64_t seed, std::uint64_t key) { return Mix(seed ^ Mix(key)); }

// 24 bits of a hash as a number in [0, 1).
constexpr float UnitFloat(std::uint64_t hash) { return static_cast<float>(hash >> 40) * 0x1.0p-24F; }

// A standard normal number from one hash (Box-Muller).
inline float NormalFloat(std::uint64_t hash) {
  const float u = (static_cast<float>(hash >> 40) + 0.5F) * 0x1.0p-24F;
  const float v = static_cast<float>((hash >> 8) & 0xFFFFFF) * 0x1.0p-24F;
  return std::sqrt(-2.0F * std::log(u)) * std::cos(6.2831853F * v);
}

// A sequence of draws for whoever works alone: scenarios and tests.
class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}

  std::uint64_t Next() { return Mix(seed_, ++count_); }
  // [low, high).
  double Uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(Next() >> 11) * 0x1.0p-53);
  }
  // 0 .. count - 1.
  int Below(int count) { return static_cast<int>(Uniform(0, count)); }
  bool Chance(double probability) { return Uniform(0, 1) < probability; }

 private:
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_RANDOM_H_
