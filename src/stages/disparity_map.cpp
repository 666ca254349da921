#include "stages/disparity_map.h"

#include <algorithm>

#include "base/check.h"
#include "base/simd.h"

namespace wirepose {
namespace {

using Scratch = DisparityScratch;
constexpr int kDepth = kMapDisparities;
constexpr std::uint8_t kMaxSmallStep = 40;
constexpr std::uint8_t kGuard = 0xFF - kMaxSmallStep;  // above all costs; what a step adds still fits

// Means of 2 x 2 pixels of row pair j.
WIREPOSE_VECTOR_KERNEL void HalveRow(const NormalizedPlane& plane, int j, int width, std::uint8_t* __restrict out) {
  const std::uint8_t* a = plane.data() + static_cast<std::ptrdiff_t>(2 * j) * kMaxImageWidth;
  const std::uint8_t* b = a + kMaxImageWidth;
  for (int i = 0; i < width; ++i) {
    const auto sum = static_cast<std::uint16_t>(a[2 * i] + a[2 * i + 1] + b[2 * i] + b[2 * i + 1] + 2);
    out[i] = static_cast<std::uint8_t>(sum / 4);
  }
}

// difference[x][d] = |left(x) - right(x - d)| in steps, clipped; what lies left of the right image costs the most.
WIREPOSE_VECTOR_KERNEL void FillDifferences(const Scratch::Row& left, const std::uint8_t* right_reversed, int width,
                                            std::uint8_t clip, std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    const std::uint8_t l = left[static_cast<std::size_t>(x)];
    const std::uint8_t* r = right_reversed + (width - 1 - x);  // right(x - d) at [d]
    std::uint8_t* o = out + x * kDepth;
    for (int d = 0; d < kDepth; ++d) {
      const auto difference = static_cast<std::uint8_t>((l > r[d] ? l : r[d]) - (l > r[d] ? r[d] : l));
      const auto steps = static_cast<std::uint8_t>(difference / kDifferenceStep);
      o[d] = steps < clip ? steps : clip;
    }
    for (int d = x + 1; d < kDepth; ++d) o[d] = clip;
  }
}

// Sum of one column of three pixels, all disparities.
inline void SumColumn(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c, std::uint8_t* out) {
  for (int d = 0; d < kDepth; ++d) out[d] = static_cast<std::uint8_t>(a[d] + b[d] + c[d]);
}

// cost[x] = sum of columns x - 1, x and x + 1 of three rows of differences, the border repeated.
WIREPOSE_VECTOR_KERNEL void SumNeighbours(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                                          int width, std::uint8_t* __restrict cost) {
  std::uint8_t columns[3][kDepth];
  SumColumn(a, b, c, columns[0]);
  SumColumn(a, b, c, columns[2]);  // stands before the first
  for (int x = 0; x < width; ++x) {
    const int next = std::min(x + 1, width - 1) * kDepth;
    SumColumn(a + next, b + next, c + next, columns[(x + 1) % 3]);
    std::uint8_t* out = cost + x * kDepth;
    for (int d = 0; d < kDepth; ++d) {
      out[d] = static_cast<std::uint8_t>(columns[0][d] + columns[1][d] + columns[2][d]);
    }
  }
}

struct Steps {
  std::uint8_t small, large;
};

// One step of a path: L(d) = C(d) + min(L'(d), L'(d +- 1) + small, min L' + large) - min L'. Writes L to `out` and
// returns its minimum. Guards stay.
WIREPOSE_INLINE std::uint8_t Advance(const std::uint8_t* cost, const Scratch::Path& before, std::uint8_t lowest,
                                     Steps steps, Scratch::Path& path) {
  const auto limit = static_cast<std::uint8_t>(lowest + steps.large);
  const std::uint8_t* previous = before.data() + 1;
  std::uint8_t* out = path.data() + 1;
  std::uint8_t least = 0xFF;
  for (int d = 0; d < kDepth; ++d) {
    const std::uint8_t side = previous[d - 1] < previous[d + 1] ? previous[d - 1] : previous[d + 1];
    const auto stepped = static_cast<std::uint8_t>(side + steps.small);
    std::uint8_t m = previous[d] < stepped ? previous[d] : stepped;
    m = m < limit ? m : limit;
    const auto value = static_cast<std::uint8_t>(cost[d] + m - lowest);
    out[d] = value;
    least = least < value ? least : value;
  }
  return least;
}

void Reset(Scratch::Path& path) {
  path.fill(0);
  path.front() = path.back() = kGuard;
}

// The three paths of a row; rows alternate in `parity`. Both directions at once: each waits for its own last step only.
WIREPOSE_VECTOR_KERNEL void FollowPaths(Steps steps, int width, std::size_t parity, const Scratch::Path& start,
                                        Scratch& s) {
  const Scratch::Path *left = &start, *right = &start;
  std::uint8_t left_lowest = 0, right_lowest = 0;
  for (int x = 0; x < width; ++x) {
    const auto i = static_cast<std::size_t>(x), mirrored = static_cast<std::size_t>(width - 1 - x);
    const std::uint8_t* cost = s.cost.data() + i * kDepth;
    left_lowest = Advance(cost, *left, left_lowest, steps, s.from_left[i]);
    s.above_lowest[i] = Advance(cost, s.above[1 - parity][i], s.above_lowest[i], steps, s.above[parity][i]);
    right_lowest = Advance(s.cost.data() + mirrored * kDepth, *right, right_lowest, steps, s.from_right[mirrored]);
    left = &s.from_left[i];
    right = &s.from_right[mirrored];
  }
}

// The three paths' costs at a pixel, by disparity.
struct PathCosts {
  const std::uint8_t *left, *right, *above;

  PathCosts(const Scratch& scratch, std::size_t parity, int x)
      : left(scratch.from_left[static_cast<std::size_t>(x)].data() + 1),
        right(scratch.from_right[static_cast<std::size_t>(x)].data() + 1),
        above(scratch.above[parity][static_cast<std::size_t>(x)].data() + 1) {}
  [[nodiscard]] int Sum(int d) const { return left[d] + right[d] + above[d]; }
};

struct Winner {
  std::uint16_t disparity, cost;
};

// The first of the lowest sums. Sum and disparity as one number, so that one minimum finds both.
WIREPOSE_INLINE Winner FindLowest(const PathCosts& costs) {
  static_assert((3 * 0xFF + 1) * kDepth <= 0xFFFF);
  std::uint16_t lowest = 0xFFFF;
  for (int d = 0; d < kDepth; ++d) {
    const auto both = static_cast<std::uint16_t>(costs.Sum(d) * kDepth + d);
    lowest = lowest < both ? lowest : both;
  }
  return {static_cast<std::uint16_t>(lowest % kDepth), static_cast<std::uint16_t>(lowest / kDepth)};
}

// The winner of every pixel of both images.
WIREPOSE_VECTOR_KERNEL void ChooseBest(int width, std::size_t parity, Scratch& scratch) {
  auto& [right_cost, right_disparity] = scratch.best_right;
  right_cost.fill(0xFFFF);
  right_disparity.fill(0);
  for (int x = 0; x < width; ++x) {
    const Winner best = FindLowest({scratch, parity, x});
    scratch.best_left[static_cast<std::size_t>(x)] = best.disparity;
    const auto r = static_cast<std::size_t>(std::max(0, x - best.disparity));
    if (x < best.disparity || best.cost >= right_cost[r]) continue;
    right_cost[r] = best.cost;
    right_disparity[r] = best.disparity;
  }
}

// Vertex of the parabola through the costs beside the winner, in units of the map.
std::uint16_t Refined(const PathCosts& costs, int d) {
  constexpr int kUnit = static_cast<int>(DisparityMap::kOne) * DisparityMap::kScale;
  int shift = 0;
  if (d > 0 && d + 1 < kDepth) {
    const int before = costs.Sum(d - 1), here = costs.Sum(d), after = costs.Sum(d + 1);
    const int bend = before - 2 * here + after;
    if (bend > 0) shift = (before - after) * kUnit / (2 * bend);
  }
  return static_cast<std::uint16_t>(std::max(1, d * kUnit + std::clamp(shift, -kUnit / 2, kUnit / 2)));
}

void WriteRow(int max_asymmetry, int width, std::size_t parity, const Scratch& scratch, std::uint16_t* out) {
  for (int x = 0; x < width; ++x) {
    out[x] = DisparityMap::kUnknown;
    const int d = scratch.best_left[static_cast<std::size_t>(x)];
    if (d > x) continue;
    const int back = scratch.best_right[1][static_cast<std::size_t>(x - d)];
    // Nothing is at infinity: blank areas that no texture reaches end up there.
    if (d > 0 && std::abs(back - d) <= max_asymmetry) out[x] = Refined({scratch, parity, x}, d);
  }
}

constexpr auto kTolerance = static_cast<std::uint16_t>(2 * DisparityMap::kOne);

inline std::uint16_t Agree(std::uint16_t a, std::uint16_t b) {
  const auto difference = static_cast<std::uint16_t>(a > b ? a - b : b - a);
  return difference <= kTolerance ? 1 : 0;
}

// A pixel that fewer than two of its four neighbours confirm is unknown. `use_above`, `use_below`: 1 where the image
// has such a row, else 0.
WIREPOSE_VECTOR_KERNEL void DropSpeckles(const std::uint16_t* above, const std::uint16_t* here,
                                         const std::uint16_t* below, std::uint16_t use_above, std::uint16_t use_below,
                                         int width, std::uint16_t* __restrict out) {
  for (int x = 0; x < width; ++x) {
    out[x] =
        static_cast<std::uint16_t>((Agree(above[x], here[x]) & use_above) + (Agree(below[x], here[x]) & use_below));
  }
  for (int x = 1; x < width; ++x) out[x] = static_cast<std::uint16_t>(out[x] + Agree(here[x - 1], here[x]));
  for (int x = 0; x < width - 1; ++x) out[x] = static_cast<std::uint16_t>(out[x] + Agree(here[x + 1], here[x]));
  for (int x = 0; x < width; ++x) out[x] = out[x] >= 2 ? here[x] : DisparityMap::kUnknown;
}

void ReadDifferences(const DisparityMapParams& params, const NormalizedPlane& left, const NormalizedPlane& right, int j,
                     int width, Scratch& scratch) {
  Scratch::Row l, r;
  HalveRow(left, j, width, l.data());
  HalveRow(right, j, width, r.data());
  std::array<std::uint8_t, Scratch::kWidth + kDepth> reversed{};
  for (int x = 0; x < width; ++x) reversed[static_cast<std::size_t>(width - 1 - x)] = r[static_cast<std::size_t>(x)];
  FillDifferences(l, reversed.data(), width, params.max_difference,
                  scratch.difference[static_cast<std::size_t>(j % 3)].data());
}

}  // namespace

void ComputeDisparityMap(const DisparityMapParams& params, int width, int height, const NormalizedPlane& left,
                         const NormalizedPlane& right, DisparityScratch& scratch, DisparityMap& out) {
  Check(params.small_step <= kMaxSmallStep && 9 * params.max_difference + params.large_step < kGuard);
  out.width = width / DisparityMap::kScale;
  out.height = height / DisparityMap::kScale;
  Scratch::Path start;
  Reset(start);
  scratch.from_left.fill(start);
  scratch.from_right.fill(start);
  for (auto& row : scratch.above) row.fill(start);
  scratch.above_lowest.fill(0);
  const auto row = [&](int j) {
    return scratch.difference[static_cast<std::size_t>(std::clamp(j, 0, out.height - 1) % 3)].data();
  };
  constexpr std::ptrdiff_t kWidth = DisparityMap::kMaxWidth;
  const int matched = (out.height + kRowStep - 1) / kRowStep;
  int read = 0;
  for (int k = 0; k < matched; ++k) {
    const int j = k * kRowStep;
    for (; read < std::min(j + 2, out.height); ++read) ReadDifferences(params, left, right, read, out.width, scratch);
    SumNeighbours(row(j - 1), row(j), row(j + 1), out.width, scratch.cost.data());
    const auto parity = static_cast<std::size_t>(k % 2);
    FollowPaths({params.small_step, params.large_step}, out.width, parity, start, scratch);
    ChooseBest(out.width, parity, scratch);
    WriteRow(params.max_asymmetry, out.width, parity, scratch, scratch.raw.data() + k * kWidth);
  }
  for (int k = 0; k < matched; ++k) {
    const std::uint16_t* here = scratch.raw.data() + k * kWidth;
    const bool first = k == 0, last = k + 1 == matched;
    std::uint16_t* to = out.disparity.data() + k * kRowStep * kWidth;
    DropSpeckles(first ? here : here - kWidth, here, last ? here : here + kWidth, first ? 0 : 1, last ? 0 : 1,
                 out.width, to);
    for (int j = 1; j < kRowStep && k * kRowStep + j < out.height; ++j) std::copy_n(to, out.width, to + j * kWidth);
  }
}

}  // namespace wirepose
