#include "stages/edge_map.h"

#include <algorithm>
#include <bit>

#include "base/simd.h"

namespace wirepose {
namespace {

std::uint16_t DirectionAndNeighbours(int direction) {
  const auto rotate = [](int d) {
    return static_cast<std::uint16_t>(1U << ((d + EdgeMap::kDirections) % EdgeMap::kDirections));
  };
  return static_cast<std::uint16_t>(rotate(direction - 1) | rotate(direction) | rotate(direction + 1));
}

// Of every second one of `count` cells.
WIREPOSE_VECTOR_KERNEL std::uint32_t CountBits(const std::uint16_t* cells, int count) {
  std::uint32_t bits = 0;
  for (int i = 0; i < count; ++i) bits += static_cast<std::uint32_t>(std::popcount(cells[2 * i]));
  return bits;
}

}  // namespace

void BuildEdgeMap(const EdgeImage& edges, EdgeMap& out) {
  constexpr int kScale = EdgeMap::kScale, kRadius = EdgeMap::kRadius;
  static_assert(kScale == 2 && kRadius == 2, "the cells within the radius are written out");
  out.width = edges.width;
  out.height = edges.height;
  out.threshold = static_cast<float>(edges.threshold);
  const int columns = (edges.width + 1) / kScale, rows = (edges.height + 1) / kScale;
  std::fill(out.directions.begin(), out.directions.begin() + static_cast<std::ptrdiff_t>(rows) * EdgeMap::kStride,
            std::uint16_t{0});
  // Ridges keep 3 pixels from the border.
  for (std::uint32_t k = 0; k < edges.ridge_count; ++k) {
    const std::uint32_t pixel = edges.ridge_pixels[k];
    const int x = static_cast<int>(pixel % kMaxImageWidth), y = static_cast<int>(pixel / kMaxImageWidth);
    // The edge runs across its gradient.
    const std::uint16_t bits = DirectionAndNeighbours(
        EdgeMap::Direction(static_cast<float>(-edges.gy[pixel]), static_cast<float>(edges.gx[pixel])));
    std::uint16_t* cell = out.directions.data() + (y / kScale) * EdgeMap::kStride + x / kScale;
    // From an even place the cells before, at and after it are near, from an odd one those on both sides; of nine the
    // corners are too far.
    const bool odd_x = x % kScale != 0, odd_y = y % kScale != 0;
    for (int dj = odd_y ? 0 : -1; dj <= 1; ++dj) {
      for (int di = odd_x ? 0 : -1; di <= 1; ++di) {
        if (!odd_x && !odd_y && di != 0 && dj != 0) continue;
        std::uint16_t& near = cell[dj * EdgeMap::kStride + di];
        near = static_cast<std::uint16_t>(near | bits);
      }
    }
  }
  const int counted_columns = std::max(0, columns - 3) / 2, counted_rows = std::max(0, rows - 3) / 2;
  std::uint32_t set = 0;
  for (int j = 0; j < counted_rows; ++j)
    set += CountBits(out.directions.data() + (2 * j + 2) * EdgeMap::kStride + 2, counted_columns);
  const auto count = static_cast<std::uint32_t>(counted_rows * counted_columns * EdgeMap::kDirections);
  out.background = count > 0 ? static_cast<float>(set) / static_cast<float>(count) : 0.0F;
}

}  // namespace wirepose
