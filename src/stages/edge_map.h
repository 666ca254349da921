// Where edges of which orientation are: one look-up answers "is there an edge along this direction, within 2 px?", to
// the nearest cell of two pixels.
#ifndef WIREPOSE_STAGES_EDGE_MAP_H_
#define WIREPOSE_STAGES_EDGE_MAP_H_

#include <array>
#include <cmath>
#include <cstdint>

#include "stages/edge_image.h"

namespace wirepose {

// Bit k of a cell is set when a ridge pixel within kRadius of its middle runs in direction k (modulo half a turn) or
// next to it. Cells are two pixels wide: the map stays in the cache that thousands of poses a frame look it up from.
struct EdgeMap {
  static constexpr int kDirections = 16;
  static constexpr int kRadius = 2;
  static constexpr int kScale = 2;  // pixels a cell; the middle of cell (i, j) is pixel (2 i, 2 j)
  static constexpr int kStride = kMaxImageWidth / kScale;

  int width = 0, height = 0;  // of the image
  std::array<std::uint16_t, std::size_t{kStride} * (kMaxImageHeight / kScale)> directions;
  float threshold = 0;   // gradient from which on a pixel may be an edge in this image, kGradientOne
  float background = 0;  // share of (pixel, direction) pairs that are set: the rate at which a random edge is supported

  // Direction index 0..15 of an edge along (dx, dy), without trigonometry: the half turn is cut into sixteen
  // sectors of 11.25 degrees.
  static int Direction(float dx, float dy) {
    // Tangents of 11.25, 22.5 and 33.75 degrees: sector borders within 45 degrees.
    const float ax = std::abs(dx), ay = std::abs(dy);
    const bool steep = ay > ax;
    const float low = steep ? ax : ay;
    const float high = steep ? ay : ax;
    const int sector =
        (low > 0.19891237F * high ? 1 : 0) + (low > 0.41421356F * high ? 1 : 0) + (low > 0.66817864F * high ? 1 : 0);
    const int first_quadrant = steep ? 7 - sector : sector;  // 0..7 counts 11.25 degrees from the x axis
    return (dx >= 0) == (dy >= 0) ? first_quadrant : kDirections - 1 - first_quadrant;
  }

  [[nodiscard]] bool Contains(float x, float y) const {
    return x >= 4 && y >= 4 && x < static_cast<float>(width - 4) && y < static_cast<float>(height - 4);
  }
  // Requires Contains(x, y).
  [[nodiscard]] bool HasEdge(float x, float y, int direction) const {
    constexpr float kCells = 1.0F / kScale;
    return HasEdgeAt(static_cast<int>(x * kCells + 0.5F), static_cast<int>(y * kCells + 0.5F), direction);
  }
  // Of a cell that lies in the map.
  [[nodiscard]] bool HasEdgeAt(int i, int j, int direction) const {
    return ((directions[static_cast<std::size_t>(j * kStride + i)] >> direction) & 1U) != 0;
  }
};

// O(pixels / 4 + ridge pixels * 6).
void BuildEdgeMap(const EdgeImage& edges, EdgeMap& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_EDGE_MAP_H_
