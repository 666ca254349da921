#include "stages/edge_map.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace wirepose {
namespace {

std::uint16_t DirectionAndNeighbours(int direction) {
  const auto rotate = [](int d) {
    return static_cast<std::uint16_t>(1U << ((d + EdgeMap::kDirections) % EdgeMap::kDirections));
  };
  return static_cast<std::uint16_t>(rotate(direction - 1) | rotate(direction) | rotate(direction + 1));
}

}  // namespace

void BuildEdgeMap(const EdgeImage& edges, EdgeMap& out) {
  out.width = edges.width;
  out.height = edges.height;
  out.threshold = static_cast<float>(edges.threshold);
  std::fill(out.directions.begin(),
            out.directions.begin() + static_cast<std::ptrdiff_t>(EdgeImage::Index(0, edges.height)), std::uint16_t{0});
  // A disc of radius 2 around each ridge pixel: rows of 5 pixels, the outer ones of 4. Ridges keep 3 pixels from the
  // border.
  for (std::uint32_t k = 0; k < edges.ridge_count; ++k) {
    const std::uint32_t i = edges.ridge_pixels[k];
    // The edge runs across its gradient.
    const std::uint16_t bits =
        DirectionAndNeighbours(EdgeMap::Direction(static_cast<float>(-edges.gy[i]), static_cast<float>(edges.gx[i])));
    // Four pixels at a time: the pattern is the same in each 16 bit lane, so byte order does not matter.
    const std::uint64_t four = bits * 0x0001000100010001ULL;
    std::uint16_t* centre = out.directions.data() + i;
    for (int dy = -EdgeMap::kRadius; dy <= EdgeMap::kRadius; ++dy) {
      std::uint16_t* row = centre + dy * kMaxImageWidth;
      const bool outer = dy == -EdgeMap::kRadius || dy == EdgeMap::kRadius;
      const int from = outer ? -1 : -EdgeMap::kRadius;
      std::uint64_t lanes;
      std::memcpy(&lanes, row + from, sizeof(lanes));
      lanes |= four;
      std::memcpy(row + from, &lanes, sizeof(lanes));
      if (!outer) row[EdgeMap::kRadius] = static_cast<std::uint16_t>(row[EdgeMap::kRadius] | bits);
    }
  }
  std::uint32_t set = 0, count = 0;
  for (int y = 4; y < edges.height - 4; y += 3) {
    for (int x = 4; x < edges.width - 4; x += 3) {
      set += static_cast<std::uint32_t>(std::popcount(out.directions[EdgeImage::Index(x, y)]));
      count += EdgeMap::kDirections;
    }
  }
  out.background = count > 0 ? static_cast<float>(set) / static_cast<float>(count) : 0.0F;
}

}  // namespace wirepose
