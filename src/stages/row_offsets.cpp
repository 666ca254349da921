#include "stages/row_offsets.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/simd.h"

namespace wirepose {
namespace {

constexpr int kPatchRadius = 4;
constexpr int kPatch = 2 * kPatchRadius + 1;
constexpr int kPixels = kPatch * kPatch;
constexpr int kOffsetStep = 2;  // of the coarse search: every second row of the patch
constexpr int kCoarsePixels = kPatch * (kPatchRadius + 1);
constexpr int kMargin = kPatchRadius + 2;  // a patch, its gradient, and a pixel to interpolate
constexpr std::uint16_t kNoPatchCost = 0xFFFF;

// Smaller eigenvalue of the mean structure tensor around (x, y), at every second pixel; (grey levels per pixel)^2.
float CornerStrength(const SmoothPlane& smooth, int x, int y) {
  std::int32_t xx = 0, xy = 0, yy = 0;  // 25 squares of at most 12 bits each
  int count = 0;
  for (int j = -kPatchRadius; j <= kPatchRadius; j += 2) {
    const std::int16_t* row = smooth.data() + (y + j) * kStride + x;
    for (int i = -kPatchRadius; i <= kPatchRadius; i += 2) {
      const int gx = row[i + 1] - row[i - 1];
      const int gy = row[i + kStride] - row[i - kStride];
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
      ++count;
    }
  }
  const float scale = 1.0F / (static_cast<float>(count) * kGradientOne * kGradientOne);
  const float a = scale * static_cast<float>(xx), b = scale * static_cast<float>(xy),
              c = scale * static_cast<float>(yy);
  return 0.5F * (a + c - std::sqrt((a - c) * (a - c) + 4 * b * b));
}

// Adds |left - right| of one pixel to the costs of all disparities. `cost` counts down from disparity
// `reachable - 1`, so that memory runs up.
WIREPOSE_VECTOR_KERNEL void AddRow(const std::uint8_t* left, const std::uint8_t* right, int reachable,
                                   std::uint16_t* cost) {
  for (int j = 0; j < kPatch; ++j) {
    const std::uint8_t l = left[j];
    for (int k = 0; k < reachable; ++k) {
      const std::uint8_t r = right[k + j];
      const auto difference = static_cast<std::uint8_t>((l > r ? l : r) - (l > r ? r : l));
      cost[k] = static_cast<std::uint16_t>(cost[k] + difference);
    }
  }
}
static_assert(kCoarsePixels * 255 < kNoPatchCost, "costs fit 16 bits");

WIREPOSE_VECTOR_KERNEL std::uint16_t Lowest(const std::uint16_t* cost, int count) {
  std::uint16_t lowest = kNoPatchCost;
  for (int k = 0; k < count; ++k) lowest = lowest < cost[k] ? lowest : cost[k];
  return lowest;
}

// A place in the right image, relative to the corner.
struct Place {
  int disparity = 0, rows = 0;
};

// The best place there is, when none elsewhere is nearly as good.
bool FindPlace(const RowOffsetParams& params, const RowOffsetInput& in, const Corner& corner, RowOffsetScratch& scratch,
               Place& out) {
  const int x0 = corner.x - kPatchRadius;
  const int reachable = std::min(kMaxDisparity, x0 - 1);
  if (reachable < 1) return false;
  const auto rows = [&](int r) { return scratch.cost[static_cast<std::size_t>(r + kRowOffsetReach)].data(); };
  std::uint16_t best = kNoPatchCost;
  for (int r = -kRowOffsetReach; r <= kRowOffsetReach; ++r) {
    std::uint16_t* const cost = rows(r);
    std::fill(cost, cost + reachable, std::uint16_t{0});
    for (int j = -kPatchRadius; j <= kPatchRadius; j += kOffsetStep) {
      const std::uint8_t* const left = in.left.data() + (corner.y + j) * kStride + x0;
      AddRow(left, in.right.data() + (corner.y + r + j) * kStride + x0 - (reachable - 1), reachable, cost);
    }
    const std::uint16_t lowest = Lowest(cost, reachable);
    if (lowest >= best) continue;
    best = lowest;
    const auto at = static_cast<int>(std::find(cost, cost + reachable, lowest) - cost);
    out = {reachable - 1 - at, r};
  }
  if (static_cast<float>(best) > params.max_cost * kCoarsePixels) return false;
  if (std::abs(out.rows) == kRowOffsetReach) return false;  // the true one may lie beyond

  constexpr int kNear = 2;  // places this near are the same one
  const int at = reachable - 1 - out.disparity;
  std::uint16_t second = kNoPatchCost;
  for (int r = -kRowOffsetReach; r <= kRowOffsetReach; ++r) {
    const std::uint16_t* const cost = rows(r);
    if (std::abs(r - out.rows) > kNear) {
      second = std::min(second, Lowest(cost, reachable));
    } else {
      const int before = std::max(0, at - kNear), after = std::min(reachable, at + kNear + 1);
      second = std::min({second, Lowest(cost, before), Lowest(cost + after, reachable - after)});
    }
  }
  return static_cast<float>(best) <= params.max_cost_ratio * static_cast<float>(second);
}

struct Patch {
  std::array<float, kPixels> value;  // mean taken away
  float deviation = 0;               // root of the sum of squares
};

void TakeMeanAway(Patch& patch) {
  float sum = 0;
  for (const float v : patch.value) sum += v;
  const float mean = sum / kPixels;
  float square = 0;
  for (float& v : patch.value) {
    v -= mean;
    square += v * v;
  }
  patch.deviation = std::sqrt(square);
}

// Bilinear, around (x, y); false outside of the image.
bool Resample(const SmoothPlane& smooth, float x, float y, int width, int height, Patch& out) {
  if (!(x >= kMargin && y >= kMargin && x < static_cast<float>(width - kMargin) &&
        y < static_cast<float>(height - kMargin))) {
    return false;
  }
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
  std::size_t k = 0;
  for (int j = -kPatchRadius; j <= kPatchRadius; ++j) {
    const std::int16_t* const row = smooth.data() + (iy + j) * kStride + ix;
    for (int i = -kPatchRadius; i <= kPatchRadius; ++i) {
      const auto at = [&](int offset) { return static_cast<float>(row[i + offset]); };
      const float top = at(0) + fx * (at(1) - at(0));
      const float bottom = at(kStride) + fx * (at(kStride + 1) - at(kStride));
      out.value[k++] = top + fy * (bottom - top);
    }
  }
  TakeMeanAway(out);
  return true;
}

// The left patch with its gradient: what stays the same from step to step.
struct Template {
  Patch patch;
  std::array<float, kPixels> gx, gy;
  float xx = 0, xy = 0, yy = 0;
};

void MakeTemplate(const SmoothPlane& smooth, const Corner& corner, Template& out) {
  std::size_t k = 0;
  for (int j = -kPatchRadius; j <= kPatchRadius; ++j) {
    const std::int16_t* const row = smooth.data() + (corner.y + j) * kStride + corner.x;
    for (int i = -kPatchRadius; i <= kPatchRadius; ++i, ++k) {
      out.patch.value[k] = static_cast<float>(row[i]);
      out.gx[k] = 0.5F * static_cast<float>(row[i + 1] - row[i - 1]);
      out.gy[k] = 0.5F * static_cast<float>(row[i + kStride] - row[i - kStride]);
    }
  }
  TakeMeanAway(out.patch);
  for (k = 0; k < kPixels; ++k) {
    out.xx += out.gx[k] * out.gx[k];
    out.xy += out.gx[k] * out.gy[k];
    out.yy += out.gy[k] * out.gy[k];
  }
}

// Moves (x, y) in the right image until the patches lie on each other. False when they do not come to.
bool RefinePlace(const RowOffsetParams& params, const RowOffsetInput& in, const Template& left, float& x, float& y) {
  constexpr int kSteps = 6;
  constexpr float kFarthest = 1.5F, kSettled = 0.03F;
  const float det = left.xx * left.yy - left.xy * left.xy;
  if (!(det > 0) || !(left.patch.deviation > 0)) return false;
  const float x0 = x, y0 = y;
  Patch right;
  for (int step = 0; step < kSteps; ++step) {
    if (!Resample(in.right_smooth, x, y, in.width, in.height, right) || !(right.deviation > 0)) return false;
    const float gain = left.patch.deviation / right.deviation;
    float bx = 0, by = 0;
    for (std::size_t k = 0; k < kPixels; ++k) {
      const float error = gain * right.value[k] - left.patch.value[k];
      bx += left.gx[k] * error;
      by += left.gy[k] * error;
    }
    const float dx = (left.yy * bx - left.xy * by) / det, dy = (left.xx * by - left.xy * bx) / det;
    x -= dx;
    y -= dy;
    if (std::abs(x - x0) > kFarthest || std::abs(y - y0) > kFarthest) return false;
    if (std::abs(dx) < kSettled && std::abs(dy) < kSettled) {
      float product = 0;
      for (std::size_t k = 0; k < kPixels; ++k) product += left.patch.value[k] * right.value[k];
      return product >= params.min_correlation * left.patch.deviation * right.deviation;
    }
  }
  return false;
}

// Patches that reach beyond what the raw images show hold repeated pixels.
bool IsSeen(const RectificationMap& map, float x, float y) {
  const auto row = static_cast<std::size_t>(y + 0.5F);
  for (const std::size_t r : {row - kPatchRadius, row + kPatchRadius}) {
    const RectificationMap::Interval& valid = map.valid[r];
    if (x - kMargin < static_cast<float>(valid.begin) || x + kMargin >= static_cast<float>(valid.end)) return false;
  }
  return true;
}

}  // namespace

void FindCorners(const RowOffsetParams& params, const SmoothPlane& smooth, int width, int height,
                 const Segments& segments, Corners& out) {
  std::array<Corner, kMaxRowOffsets> best{};
  std::array<float, kMaxRowOffsets> strength{};
  constexpr int kFromRows = kMargin + kRowOffsetReach;  // the search looks that far up and down
  for (const Segment2& segment : segments.items) {
    for (const Vector2& end : {segment.a, segment.b}) {
      const int x = static_cast<int>(end.x() + 0.5F), y = static_cast<int>(end.y() + 0.5F);
      if (x < kMargin || y < kFromRows || x >= width - kMargin || y >= height - kFromRows) continue;
      const auto cell =
          static_cast<std::size_t>(y * kRowOffsetCellsY / height * kRowOffsetCellsX + x * kRowOffsetCellsX / width);
      const float s = CornerStrength(smooth, x, y);
      if (s < params.min_corner || s <= strength[cell]) continue;
      strength[cell] = s;
      best[cell] = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
    }
  }
  out.clear();
  for (std::size_t cell = 0; cell < kMaxRowOffsets; ++cell) {
    if (strength[cell] > 0) out.push_back(best[cell]);
  }
}

void MeasureRowOffsets(const RowOffsetParams& params, const RowOffsetInput& input, const Corners& corners,
                       RowOffsetScratch& scratch, RowOffsets& out) {
  out.clear();
  for (const Corner& corner : corners) {
    const auto cx = static_cast<float>(corner.x), cy = static_cast<float>(corner.y);
    Place place;
    if (!IsSeen(input.left_map, cx, cy) || !FindPlace(params, input, corner, scratch, place)) continue;
    Template left;
    MakeTemplate(input.left_smooth, corner, left);
    float x = cx - static_cast<float>(place.disparity), y = cy + static_cast<float>(place.rows);
    if (!RefinePlace(params, input, left, x, y) || !IsSeen(input.right_map, x, y)) continue;
    out.push_back({cx, cy, cx - x, y - cy});
  }
}

}  // namespace wirepose
