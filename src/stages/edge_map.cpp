#include "stages/edge_map.h"

#include <algorithm>
#include <bit>

#include "base/simd.h"

namespace wirepose {
namespace {

// Bits of a direction and of those next to it.
constexpr std::array<std::uint16_t, EdgeMap::kDirections> DirectionsAndNeighbours() {
  std::array<std::uint16_t, EdgeMap::kDirections> bits{};
  for (int d = 0; d < EdgeMap::kDirections; ++d) {
    for (int n = d - 1; n <= d + 1; ++n)
      bits[static_cast<std::size_t>(d)] |=
          static_cast<std::uint16_t>(1U << ((n + EdgeMap::kDirections) % EdgeMap::kDirections));
  }
  return bits;
}

// Sets `bits` in `count` cells.
inline void Mark(std::uint16_t* cells, int count, std::uint16_t bits) {
  for (int i = 0; i < count; ++i) cells[i] = static_cast<std::uint16_t>(cells[i] | bits);
}

// Sets `bits` in the cells within the radius of pixel (x, y), which lies in `cell`: from an even place the cells
// before, at and after it are near, from an odd one those on both sides; of nine the corners are too far.
inline void MarkAround(std::uint16_t* cell, int x, int y, std::uint16_t bits) {
  static_assert(EdgeMap::kScale == 2 && EdgeMap::kRadius == 2, "the cells within the radius are written out");
  constexpr int kStride = EdgeMap::kStride;
  const bool odd_x = x % 2 != 0, odd_y = y % 2 != 0;
  if (odd_x) {
    Mark(cell, 2, bits);
    Mark(cell + kStride, 2, bits);
    if (!odd_y) Mark(cell - kStride, 2, bits);
  } else if (odd_y) {
    Mark(cell - 1, 3, bits);
    Mark(cell + kStride - 1, 3, bits);
  } else {
    Mark(cell - kStride, 1, bits);
    Mark(cell - 1, 3, bits);
    Mark(cell + kStride, 1, bits);
  }
}

// Of every second one of `count` cells.
WIREPOSE_VECTOR_KERNEL std::uint32_t CountBits(const std::uint16_t* cells, int count) {
  std::uint32_t bits = 0;
  for (int i = 0; i < count; ++i) bits += static_cast<std::uint32_t>(std::popcount(cells[2 * i]));
  return bits;
}

}  // namespace

void BuildEdgeMap(const EdgeImage& edges, EdgeMap& out) {
  constexpr int kScale = EdgeMap::kScale;
  static constexpr auto kBits = DirectionsAndNeighbours();
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
    const int direction = EdgeMap::Direction(static_cast<float>(-edges.gy[pixel]), static_cast<float>(edges.gx[pixel]));
    MarkAround(out.directions.data() + (y / kScale) * EdgeMap::kStride + x / kScale, x, y,
               kBits[static_cast<std::size_t>(direction)]);
  }
  const int counted_columns = std::max(0, columns - 3) / 2, counted_rows = std::max(0, rows - 3) / 2;
  std::uint32_t set = 0;
  for (int j = 0; j < counted_rows; ++j)
    set += CountBits(out.directions.data() + (2 * j + 2) * EdgeMap::kStride + 2, counted_columns);
  const auto count = static_cast<std::uint32_t>(counted_rows * counted_columns * EdgeMap::kDirections);
  out.background = count > 0 ? static_cast<float>(set) / static_cast<float>(count) : 0.0F;
}

}  // namespace wirepose
