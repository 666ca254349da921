#include "stages/strip_search.h"

#include <algorithm>
#include <cmath>

#include "base/simd.h"

namespace wirepose {
namespace {

constexpr int kStripWidth = 7;
constexpr int kStripOverlap = 1;  // columns of the strip beyond the edge: the edge must be in the strip
constexpr std::uint16_t kNoCost = 0xFFFF / kMaxStereoRows;  // of one row: outside of the right image

// Differences of kColumns pixels of a row with those of the right image at every disparity, added to `cost`. `right`
// counts down: right[d] belongs to the last of the pixels at disparity d.
template <int kColumns>
inline void AddDifferences(const std::uint8_t* left, const std::uint8_t* right,
                           std::array<std::uint16_t, kMaxDisparity>& cost) {
  for (std::size_t d = 0; d < kMaxDisparity; ++d) {
    std::uint16_t sum = cost[d];
    for (std::size_t j = 0; j < kColumns; ++j) {
      // Difference of bytes without widening: twice the lanes of |l - r| in integers.
      const std::uint8_t l = left[j], r = right[d + kColumns - 1 - j];
      const auto difference = static_cast<std::uint8_t>((l > r ? l : r) - (l > r ? r : l));
      sum = static_cast<std::uint16_t>(sum + difference);
    }
    cost[d] = sum;
  }
}

// Of `rows` rows, kColumns pixels from `left` on, all disparities; `right` is the same place of the right image, and
// `reachable` disparities lie in it.
template <int kColumns>
inline void SumDifferences(const std::uint8_t* left, const std::uint8_t* right, int rows, int reachable,
                           std::array<std::uint16_t, kMaxDisparity>& cost) {
  cost.fill(0);
  std::array<std::uint8_t, kMaxDisparity + kColumns - 1> reversed{};
  for (int y = 0; y < rows; ++y, left += kStride, right += kStride) {
    const int count = reachable + kColumns - 1;
    for (int k = 0; k < count; ++k) reversed[static_cast<std::size_t>(k)] = right[kColumns - 1 - k];
    AddDifferences<kColumns>(left, reversed.data(), cost);
  }
}

WIREPOSE_VECTOR_KERNEL void CompareRow(const std::uint8_t* left, const std::uint8_t* right, int reachable,
                                       std::array<std::uint16_t, kMaxDisparity>& cost) {
  SumDifferences<kStripWidth>(left, right, 1, reachable, cost);
  std::fill(cost.begin() + reachable, cost.end(), kNoCost);
}

constexpr int kColumns = 3;  // of a flat line's strip

WIREPOSE_VECTOR_KERNEL void CompareColumns(const std::uint8_t* left, const std::uint8_t* right, int reachable,
                                           std::array<std::uint16_t, kMaxDisparity>& cost) {
  SumDifferences<kColumns>(left, right, kStripWidth, reachable, cost);
  for (std::uint16_t& c : cost) c = static_cast<std::uint16_t>(c / kColumns);
  std::fill(cost.begin() + reachable, cost.end(), kNoCost);
}
static_assert(kStripWidth * 255 < kNoCost);

// Steep lines: scratch.cost[row][d] for the strip that starts at column offset `begin` from the edge.
void FillRowCosts(const StereoInput& in, const RowSamples& rows, int begin, StereoScratch& scratch) {
  const int width = in.camera.width;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const int x0 = static_cast<int>(std::floor(rows[r].x + 0.5F)) + begin;
    auto& cost = scratch.cost[r];
    if (x0 < 0 || x0 + kStripWidth > width) {
      cost.fill(kNoCost);
      continue;
    }
    const std::ptrdiff_t at = rows[r].y * kStride + x0;
    CompareRow(in.left.data() + at, in.right.data() + at, std::min(kMaxDisparity, x0 + 1), cost);
  }
}

// Flat lines: samples lie along the columns, the strip reaches from the edge up or down, starting at row offset
// `begin`, and is three columns wide. It extends past the ends, where the line's end itself is what can be matched.
void FillColumnCosts(const StereoInput& in, const RowSamples& columns, int begin, StereoScratch& scratch) {
  for (std::size_t r = 0; r < columns.size(); ++r) {
    const int x0 = static_cast<int>(std::floor(columns[r].x + 0.5F)) - kColumns / 2;
    const int y0 = columns[r].y + begin;
    auto& cost = scratch.cost[r];
    if (x0 < 0 || x0 + kColumns > in.camera.width || y0 < 0 || y0 + kStripWidth > in.camera.height) {
      cost.fill(kNoCost);
      continue;
    }
    const std::ptrdiff_t at = y0 * kStride + x0;
    CompareColumns(in.left.data() + at, in.right.data() + at, std::min(kMaxDisparity, x0 + 1), cost);
  }
}

// Points along a flat line and kFlatExtension px past both of its ends.
RowSamples FlatSamples(const Segment2& s) {
  constexpr float kFlatExtension = 4;
  RowSamples samples;
  const float length = s.Length();
  const int n = std::clamp(static_cast<int>((length + 2 * kFlatExtension) / 3), 6, kMaxStereoRows);
  for (int k = 0; k < n; ++k) {
    const float along =
        -kFlatExtension + (static_cast<float>(k) + 0.5F) * (length + 2 * kFlatExtension) / static_cast<float>(n);
    const float t = along / length;
    const Vector2 p = s.a + t * s.Delta();
    samples.push_back({static_cast<int>(std::floor(p.y() + 0.5F)), p.x(), t});
  }
  return samples;
}

// Disparity at each row minus that of the middle, rounded; and the least and the largest of them.
struct Slope {
  std::array<int, kMaxStereoRows> shift;
  int low = 0, high = 0;
};

// From the segment's middle (0) to its ends (-1 and 1).
using RowPositions = std::array<float, kMaxStereoRows>;

RowPositions PositionsOf(const RowSamples& rows) {
  RowPositions positions{};
  for (std::size_t r = 0; r < rows.size(); ++r) positions[r] = 2 * rows[r].t - 1;
  return positions;
}

// Slopes advance such that the ends move by one pixel, up to this many.
constexpr int kMaxSlope = 12;

Slope MakeSlope(const RowPositions& positions, int steps) {
  constexpr int kShift = 2 * kMaxSlope;  // makes what is rounded positive: conversion truncates
  Slope slope;
  for (std::size_t r = 0; r < kMaxStereoRows; ++r) {
    const float shift = positions[r] * static_cast<float>(steps) + (static_cast<float>(kShift) + 0.5F);
    slope.shift[r] = static_cast<int>(shift) - kShift;
  }
  for (const int shift : slope.shift) {
    slope.low = std::min(slope.low, shift);
    slope.high = std::max(slope.high, shift);
  }
  return slope;
}

constexpr int kCostBlock = 16;
using RowPointers = std::array<const std::uint16_t*, kMaxStereoRows>;

// Sums the rows' costs at disparities [0, count), lowers best_at[d] to them, and returns the smallest. In blocks of
// lanes whose sum needs no memory; the last block overlaps the one before it, which changes no minimum.
WIREPOSE_VECTOR_KERNEL std::uint16_t SumAlong(const RowPointers& row, int count, std::uint16_t* __restrict sum,
                                              std::uint16_t* __restrict best_at) {
  std::uint16_t lowest[kCostBlock];
  std::fill(lowest, lowest + kCostBlock, std::uint16_t{0xFFFF});
  for (int done = 0; done < count; done += kCostBlock) {
    const int begin = std::min(done, count - kCostBlock);
    for (int k = 0; k < kCostBlock; ++k) {
      const int d = begin + k;
      const auto value =
          static_cast<std::uint16_t>(row[0][d] + row[1][d] + row[2][d] + row[3][d] + row[4][d] + row[5][d] + row[6][d] +
                                     row[7][d] + row[8][d] + row[9][d] + row[10][d] + row[11][d]);
      sum[d] = value;
      best_at[d] = best_at[d] < value ? best_at[d] : value;
      lowest[k] = lowest[k] < value ? lowest[k] : value;
    }
  }
  return *std::min_element(lowest, lowest + kCostBlock);
}
static_assert(kMaxStereoRows == 12, "SumAlong adds twelve rows");

// Lowest cost more than two disparities away from `middle`.
WIREPOSE_VECTOR_KERNEL std::uint16_t LowestBeside(const std::array<std::uint16_t, kMaxDisparity>& cost, int middle) {
  std::uint16_t lowest = 0xFFFF;
  for (int d = 0; d < middle - 2; ++d) {
    const std::uint16_t c = cost[static_cast<std::size_t>(d)];
    lowest = lowest < c ? lowest : c;
  }
  for (int d = middle + 3; d < kMaxDisparity; ++d) {
    const std::uint16_t c = cost[static_cast<std::size_t>(d)];
    lowest = lowest < c ? lowest : c;
  }
  return lowest;
}

static_assert(kMaxDisparity - 4 * kMaxSlope - 1 >= kCostBlock, "shifts stay below 2 kMaxSlope, even beyond the ends");

// Stands for rows that a short segment does not have.
constexpr std::array<std::uint16_t, kMaxDisparity> kNoRow{};

// Smallest cost over all (middle disparity, slope).
StripMatch SearchDisparity(const StereoLineParams& params, const Segment2& segment, const RowSamples& rows,
                           StereoScratch& scratch) {
  StripMatch match;
  const float reach = 0.5F * params.max_disparity_slope * segment.Length();  // of an end against the middle
  const int steps = std::min(kMaxSlope, static_cast<int>(reach));
  scratch.best_at.fill(0xFFFF);
  const RowPositions positions = PositionsOf(rows);
  std::uint32_t best = 0xFFFF;
  for (int s = -steps; s <= steps; ++s) {
    const Slope slope = MakeSlope(positions, s);
    const int first = 1 - slope.low, count = kMaxDisparity - slope.high - first;
    const auto row = [&](std::size_t r) {
      return r < rows.size() ? scratch.cost[r].data() + first + slope.shift[r] : kNoRow.data();
    };
    const std::uint16_t lowest =
        SumAlong({row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7), row(8), row(9), row(10), row(11)},
                 count, scratch.sum.data() + first, scratch.best_at.data() + first);
    if (lowest >= best) continue;
    best = lowest;
    const auto d =
        static_cast<float>(std::find(scratch.sum.begin() + first, scratch.sum.end(), lowest) - scratch.sum.begin());
    match.disparity_a = d - static_cast<float>(s);
    match.disparity_b = d + static_cast<float>(s);
  }
  const auto n = static_cast<float>(rows.size());
  if (static_cast<float>(best) >= 0.8F * static_cast<float>(kNoCost) * n) return match;
  const auto middle = static_cast<int>(0.5F * (match.disparity_a + match.disparity_b));  // whole: d of the best
  const std::uint16_t second = LowestBeside(scratch.best_at, middle);
  match.cost = static_cast<float>(best) / n;
  match.cost_ratio = (static_cast<float>(best) + n) / (static_cast<float>(second) + n);
  match.found = true;
  return match;
}

}  // namespace

RowSamples CrossedRows(const Segment2& s, int limit) {
  RowSamples rows;
  const float y0 = std::min(s.a.y(), s.b.y());
  const float y1 = std::max(s.a.y(), s.b.y());
  const int first = static_cast<int>(std::ceil(y0));
  const int last = static_cast<int>(std::floor(y1));
  const int count = last - first + 1;
  const int used = std::min(count, limit);
  for (int k = 0; k < used; ++k) {
    const int y = used == count ? first + k : first + (2 * k + 1) * count / (2 * used);
    const float t = (static_cast<float>(y) - s.a.y()) / (s.b.y() - s.a.y());
    rows.push_back({y, s.a.x() + t * (s.b.x() - s.a.x()), t});
  }
  return rows;
}

void MatchSteep(const StereoLineParams& params, const StereoInput& in, const Segment2& segment, StereoScratch& scratch,
                StripMatch& bright, StripMatch& dark) {
  const RowSamples rows = CrossedRows(segment, kMaxStereoRows);
  if (rows.size() < 4) return;
  const bool bright_is_right = segment.Normal().x() > 0;
  FillRowCosts(in, rows, -kStripOverlap, scratch);
  (bright_is_right ? bright : dark) = SearchDisparity(params, segment, rows, scratch);
  FillRowCosts(in, rows, kStripOverlap - kStripWidth + 1, scratch);
  (bright_is_right ? dark : bright) = SearchDisparity(params, segment, rows, scratch);
}

void MatchFlat(const StereoLineParams& params, const StereoInput& in, const Segment2& segment, StereoScratch& scratch,
               StripMatch& bright, StripMatch& dark) {
  const RowSamples columns = FlatSamples(segment);
  const bool bright_is_below = segment.Normal().y() > 0;
  FillColumnCosts(in, columns, -kStripOverlap, scratch);
  (bright_is_below ? bright : dark) = SearchDisparity(params, segment, columns, scratch);
  FillColumnCosts(in, columns, kStripOverlap - kStripWidth + 1, scratch);
  (bright_is_below ? dark : bright) = SearchDisparity(params, segment, columns, scratch);
}

}  // namespace wirepose
