// Stage 2: 2D segments of the left image become 3D lines.
#ifndef WIREPOSE_STAGES_STEREO_LINES_H_
#define WIREPOSE_STAGES_STEREO_LINES_H_

#include <array>
#include <cstdint>

#include "base/fixed_vector.h"
#include "geometry/line3.h"
#include "stages/edge_image.h"
#include "stages/normalize.h"
#include "stages/segments.h"

namespace wirepose {

struct StereoLineParams {
  float min_slope = 0.21F;            // |dy| / length: lines within 12 degrees of the epipolar line are flat
  float max_disparity_slope = 0.45F;  // change of disparity per pixel of line: steeper surfaces are not matched
  // A match counts when its cost is below this share of the best one elsewhere, or when both sides of the edge agree.
  float max_cost_ratio = 0.75F;
  float max_flat_cost_ratio = 0.6F;  // flat lines match by their ends and the texture beside them: ask for more
  float flat_sigma_px = 0.7F;        // of the disparity at an end of a flat line
  float side_agreement_px = 0.8F;
  // Sub-pixel refinement: the same edge in the right image, searched this far around the coarse match.
  float search_px = 2.0F;
  float min_support = 0.5F;  // share of rows that must show it
  // The least-squares sigma is several times too small (neighbouring rows share their errors): inflated, with a floor.
  float sigma_inflation = 3.0F;
  float sigma_floor_px = 0.10F;
  float coarse_sigma_px = 0.6F;  // without sub-pixel support
};

inline constexpr int kMaxDisparity = 192;  // px: 0.33 m at f*B = 63 px*m
inline constexpr int kMaxStereoRows = 12;  // rows compared along one segment

// Work space; contents have no meaning between calls.
struct StereoScratch {
  // Cost of one side: row sample x disparity.
  std::array<std::array<std::uint16_t, kMaxDisparity>, kMaxStereoRows> cost;
  std::array<std::uint16_t, kMaxDisparity> sum;
  std::array<std::uint16_t, kMaxDisparity> best_at;
};

struct StereoInput {
  const RectifiedCamera& camera;
  const NormalizedPlane& left;
  const NormalizedPlane& right;
  const SmoothPlane& right_smooth;
  const RectificationMap& right_map;
};

using Lines3 = FixedVector<Line3, kMaxSegments>;

// One line per left segment, in the same order; `has_depth` tells which ones were matched.
//
// Disparity is linear along an image line, so the search has two unknowns. Strips of 7 px on each side of the edge,
// both containing the edge, are compared with the right image by the sum of absolute differences of locally normalised
// values, for every disparity and slope; the side with the clearer minimum owns the depth, since at an occluding edge
// only the near side moves with it. Then the edge itself is found to sub-pixel precision in the rows of the right image
// and a robust line through those positions gives both end disparities with covariance.
// O(segments * kMaxStereoRows * kMaxDisparity * slopes).
void MatchLines(const StereoLineParams& params, const StereoInput& input, const Segments& segments,
                StereoScratch& scratch, Lines3& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_STEREO_LINES_H_
