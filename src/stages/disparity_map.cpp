#include "stages/disparity_map.h"

#include <algorithm>

#include "base/simd.h"

namespace wirepose {
namespace {

using Scratch = DisparityScratch;
constexpr int kDepth = kMapDisparities;
constexpr std::uint16_t kGuard = 0x3FFF;

// Means of 2 x 2 pixels of row pair j.
void HalveRow(const NormalizedPlane& plane, int j, int width, Scratch::Row& out) {
  const std::uint8_t* a = plane.data() + static_cast<std::ptrdiff_t>(2 * j) * kMaxImageWidth;
  const std::uint8_t* b = a + kMaxImageWidth;
  for (int i = 0; i < width; ++i) {
    out[static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>((a[2 * i] + a[2 * i + 1] + b[2 * i] + b[2 * i + 1] + 2) / 4);
  }
}

// difference[x][d] = |left(x) - right(x - d)|, clipped; what lies left of the right image costs the most.
WIREPOSE_VECTOR_KERNEL void FillDifferences(const Scratch::Row& left, const std::uint8_t* right_reversed, int width,
                                            std::uint8_t clip, std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    const std::uint8_t l = left[static_cast<std::size_t>(x)];
    const std::uint8_t* r = right_reversed + (width - 1 - x);  // right(x - d) at [d]
    std::uint8_t* o = out + x * kDepth;
    for (int d = 0; d < kDepth; ++d) {
      const auto difference = static_cast<std::uint8_t>((l > r[d] ? l : r[d]) - (l > r[d] ? r[d] : l));
      o[d] = difference < clip ? difference : clip;
    }
    for (int d = x + 1; d < kDepth; ++d) o[d] = clip;
  }
}

// Sum of one column of three pixels, all disparities.
inline void SumColumn(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c, std::uint16_t* out) {
  for (int d = 0; d < kDepth; ++d) out[d] = static_cast<std::uint16_t>(a[d] + b[d] + c[d]);
}

// cost[x] = sum of columns x - 1, x and x + 1 of three rows of differences, the border repeated.
WIREPOSE_VECTOR_KERNEL void SumNeighbours(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                                          int width, std::uint16_t* __restrict cost) {
  std::uint16_t columns[3][kDepth];
  SumColumn(a, b, c, columns[0]);
  SumColumn(a, b, c, columns[2]);  // stands before the first
  for (int x = 0; x < width; ++x) {
    const int next = std::min(x + 1, width - 1) * kDepth;
    SumColumn(a + next, b + next, c + next, columns[(x + 1) % 3]);
    std::uint16_t* out = cost + x * kDepth;
    for (int d = 0; d < kDepth; ++d) {
      out[d] = static_cast<std::uint16_t>(columns[0][d] + columns[1][d] + columns[2][d]);
    }
  }
}

struct Steps {
  std::uint16_t small, large;
};

// One step of a path: L(d) = C(d) + min(L'(d), L'(d +- 1) + small, min L' + large) - min L'. Adds L to `sum`, or puts
// it there (kFirst), writes it to `out` (guards stay) and returns its minimum. `previous` and `out` point at disparity
// 0 behind the guard.
template <bool kFirst>
WIREPOSE_INLINE std::uint16_t Advance(const std::uint16_t* cost, const std::uint16_t* previous, std::uint16_t lowest,
                                      Steps steps, std::uint16_t* out, std::uint16_t* sum) {
  const auto limit = static_cast<std::uint16_t>(lowest + steps.large);
  std::uint16_t least = 0xFFFF;
  for (int d = 0; d < kDepth; ++d) {
    const std::uint16_t side = previous[d - 1] < previous[d + 1] ? previous[d - 1] : previous[d + 1];
    const auto stepped = static_cast<std::uint16_t>(side + steps.small);
    std::uint16_t m = previous[d] < stepped ? previous[d] : stepped;
    m = m < limit ? m : limit;
    const auto value = static_cast<std::uint16_t>(cost[d] + m - lowest);
    out[d] = value;
    sum[d] = static_cast<std::uint16_t>(kFirst ? value : sum[d] + value);
    least = least < value ? least : value;
  }
  return least;
}

void Reset(Scratch::Path& path) {
  path.fill(0);
  path.front() = path.back() = kGuard;
}

// The paths of a row that are under way.
struct RowPaths {
  Scratch::Path from_left[2], from_right[2];
  std::uint16_t left_lowest = 0, right_lowest = 0;
};

// All three paths one step on: at column x that from the left and that from above, at its mirror image that from the
// right. Both directions at once: each waits for its own last step only. kFirst: nothing has been summed there yet.
template <bool kFirst>
WIREPOSE_INLINE void AdvanceAll(Steps steps, int width, int x, std::size_t parity, RowPaths& p, Scratch& scratch) {
  const auto column = static_cast<std::size_t>(x);
  const std::uint16_t* cost = scratch.cost.data() + x * kDepth;
  std::uint16_t* sum = scratch.sum.data() + x * kDepth;
  std::uint16_t& above_lowest = scratch.above_lowest[column];
  const int mirrored = (width - 1 - x) * kDepth;
  p.left_lowest = Advance<kFirst>(cost, p.from_left[x % 2].data() + 1, p.left_lowest, steps,
                                  p.from_left[(x + 1) % 2].data() + 1, sum);
  above_lowest = Advance<false>(cost, scratch.above[1 - parity][column].data() + 1, above_lowest, steps,
                                scratch.above[parity][column].data() + 1, sum);
  p.right_lowest = Advance<kFirst>(scratch.cost.data() + mirrored, p.from_right[x % 2].data() + 1, p.right_lowest,
                                   steps, p.from_right[(x + 1) % 2].data() + 1, scratch.sum.data() + mirrored);
}

// Sums the three paths of a row into scratch.sum; rows alternate in `parity`.
WIREPOSE_VECTOR_KERNEL void SumPaths(Steps steps, int width, std::size_t parity, Scratch& scratch) {
  RowPaths paths;
  for (std::size_t k = 0; k < 2; ++k) {
    Reset(paths.from_left[k]);
    Reset(paths.from_right[k]);
  }
  // In the middle of an odd width both directions meet in one step.
  std::fill_n(scratch.sum.begin() + static_cast<std::ptrdiff_t>(width / 2) * kDepth, kDepth, std::uint16_t{0});
  int x = 0;
  for (; x < width / 2; ++x) AdvanceAll<true>(steps, width, x, parity, paths, scratch);
  for (; x < width; ++x) AdvanceAll<false>(steps, width, x, parity, paths, scratch);
}

// The first of the lowest sums: the lowest of each block of lanes, then the place in its block.
inline int FindLowest(const std::uint16_t* sum) {
  constexpr int kBlock = 16;
  static_assert(kDepth % kBlock == 0);
  int block = 0;
  std::uint16_t lowest = 0xFFFF;
  for (int b = 0; b < kDepth; b += kBlock) {
    std::uint16_t here = 0xFFFF;
    for (int d = b; d < b + kBlock; ++d) here = here < sum[d] ? here : sum[d];
    if (here >= lowest) continue;
    lowest = here;
    block = b;
  }
  int d = block;
  while (sum[d] != lowest) ++d;
  return d;
}

// The winner of every pixel in scratch.best_left, and of every pixel of the right image.
WIREPOSE_VECTOR_KERNEL void ChooseBest(int width, Scratch& scratch) {
  auto& [right_cost, right_disparity] = scratch.best_right;
  right_cost.fill(0xFFFF);
  right_disparity.fill(0);
  for (int x = 0; x < width; ++x) {
    const std::uint16_t* sum = scratch.sum.data() + x * kDepth;
    const int d = FindLowest(sum);
    const std::uint16_t lowest = sum[d];
    scratch.best_left[static_cast<std::size_t>(x)] = static_cast<std::uint16_t>(d);
    const auto r = static_cast<std::size_t>(std::max(0, x - d));
    if (x < d || lowest >= right_cost[r]) continue;
    right_cost[r] = lowest;
    right_disparity[r] = static_cast<std::uint16_t>(d);
  }
}

// Vertex of the parabola through the costs beside the winner, in units of the map.
std::uint16_t Refined(const std::uint16_t* sum, int d) {
  constexpr int kUnit = static_cast<int>(DisparityMap::kOne) * DisparityMap::kScale;
  int shift = 0;
  if (d > 0 && d + 1 < kDepth) {
    const int before = sum[d - 1], here = sum[d], after = sum[d + 1];
    const int bend = before - 2 * here + after;
    if (bend > 0) shift = (before - after) * kUnit / (2 * bend);
  }
  return static_cast<std::uint16_t>(std::max(1, d * kUnit + std::clamp(shift, -kUnit / 2, kUnit / 2)));
}

void WriteRow(int max_asymmetry, int width, const Scratch& scratch, std::uint16_t* out) {
  for (int x = 0; x < width; ++x) {
    out[x] = DisparityMap::kUnknown;
    const int d = scratch.best_left[static_cast<std::size_t>(x)];
    if (d > x) continue;
    const int back = scratch.best_right[1][static_cast<std::size_t>(x - d)];
    // Nothing is at infinity: blank areas that no texture reaches end up there.
    if (d > 0 && std::abs(back - d) <= max_asymmetry) out[x] = Refined(scratch.sum.data() + x * kDepth, d);
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
  HalveRow(left, j, width, l);
  HalveRow(right, j, width, r);
  std::array<std::uint8_t, Scratch::kWidth + kDepth> reversed{};
  for (int x = 0; x < width; ++x) reversed[static_cast<std::size_t>(width - 1 - x)] = r[static_cast<std::size_t>(x)];
  FillDifferences(l, reversed.data(), width, static_cast<std::uint8_t>(std::min<int>(params.max_difference, 255)),
                  scratch.difference[static_cast<std::size_t>(j % 3)].data());
}

}  // namespace

void ComputeDisparityMap(const DisparityMapParams& params, int width, int height, const NormalizedPlane& left,
                         const NormalizedPlane& right, DisparityScratch& scratch, DisparityMap& out) {
  out.width = width / DisparityMap::kScale;
  out.height = height / DisparityMap::kScale;
  for (auto& row : scratch.above) {
    for (Scratch::Path& path : row) Reset(path);
  }
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
    SumPaths({params.small_step, params.large_step}, out.width, static_cast<std::size_t>(k % 2), scratch);
    ChooseBest(out.width, scratch);
    WriteRow(params.max_asymmetry, out.width, scratch, scratch.raw.data() + k * kWidth);
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
