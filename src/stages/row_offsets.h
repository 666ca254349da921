// Do equal rows of the rectified pair see equal planes of the scene? What matched corners say, one by one.
#ifndef WIREPOSE_STAGES_ROW_OFFSETS_H_
#define WIREPOSE_STAGES_ROW_OFFSETS_H_

#include <array>
#include <cstdint>

#include "base/fixed_vector.h"
#include "stages/edge_image.h"
#include "stages/normalize.h"
#include "stages/segments.h"
#include "stages/stereo_lines.h"

namespace wirepose {

struct RowOffsetParams {
  // Of the patch around a corner: least mean square of the gradient along any direction, (grey levels per pixel)^2.
  float min_corner = 6.0F;
  float max_cost = 22.0F;        // mean absolute difference of normalised values (0..255) at the best place
  float max_cost_ratio = 0.75F;  // over the best place elsewhere: repetitive texture and edges without end have none
  float min_correlation = 0.9F;  // of the patches once they lie on each other
};

// A corner of the left image, found again in the right one wherever it was, also off its row.
struct RowOffset {
  float x_px = 0, y_px = 0;  // left rectified image
  float disparity_px = 0;    // column in the left image minus column in the right one
  float offset_px = 0;       // row in the right image minus row in the left one: 0 for a rig that is as calibrated
};

// Corners are taken one a cell of the image, so that they spread over it: rotations of an eye show only far apart.
inline constexpr int kRowOffsetCellsX = 8, kRowOffsetCellsY = 4;
static_assert(std::size_t{kRowOffsetCellsX} * kRowOffsetCellsY == kMaxRowOffsets);
// Rows searched up and down. A robot's head that turns by 1 rad/s moves by 7 rows in 14 ms at f 500 px.
inline constexpr int kRowOffsetReach = 7;

struct Corner {
  std::int16_t x = 0, y = 0;
};
using Corners = FixedVector<Corner, kMaxRowOffsets>;
using RowOffsets = FixedVector<RowOffset, kMaxRowOffsets>;

// Work space; contents have no meaning between calls.
struct RowOffsetScratch {
  std::array<std::array<std::uint16_t, kMaxDisparity>, 2 * kRowOffsetReach + 1> cost;  // row offset x disparity
};

// The ends of segments where the image has gradient in all directions (smaller eigenvalue of the structure tensor,
// Shi and Tomasi 1994), the best one a cell, row by row. O(segments).
void FindCorners(const RowOffsetParams& params, const SmoothPlane& smooth, int width, int height,
                 const Segments& segments, Corners& out);

struct RowOffsetInput {
  int width = 0, height = 0;
  const NormalizedPlane& left;
  const NormalizedPlane& right;
  const SmoothPlane& left_smooth;
  const SmoothPlane& right_smooth;
  const RectificationMap& left_map;
  const RectificationMap& right_map;
};

// Looks for each corner in the right image at all disparities and kRowOffsetReach rows up and down, by the sum of
// absolute differences; keeps what is unique, and refines it to a fraction of a pixel by least squares on the smoothed
// images (Lucas and Kanade, inverse compositional, gain and offset between the eyes taken away). The search knows
// nothing of rows being equal, so that its result does not lean towards zero. In the order of the corners.
// O(corners * rows * kMaxDisparity * patch).
void MeasureRowOffsets(const RowOffsetParams& params, const RowOffsetInput& input, const Corners& corners,
                       RowOffsetScratch& scratch, RowOffsets& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_ROW_OFFSETS_H_
