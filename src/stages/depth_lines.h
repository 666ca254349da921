// Stage 2, camera with depth: 2D segments become 3D lines by the depth of the surfaces beside them.
#ifndef WIREPOSE_STAGES_DEPTH_LINES_H_
#define WIREPOSE_STAGES_DEPTH_LINES_H_

#include "stages/disparity_image.h"
#include "stages/segments.h"
#include "stages/stereo_lines.h"

namespace wirepose {

struct DepthLineParams {
  // On each side of a segment a strip is read: this far from it, where the edge itself no longer disturbs the depth and
  // the surface is still that of the edge.
  float first_px = 3, last_px = 9;
  float step_px = 3;          // between samples along the segment; widened for long ones
  float scale_px = 0.7F;      // disparities that are off the side's plane by more than this count little
  float min_support = 0.35F;  // share of a side's samples that must be known and lie on its plane
  float side_agreement_px = 1.0F, side_agreement_share = 0.015F;  // of both sides at an edge without a jump of depth
  // Neighbouring pixels of a depth sensor share their errors, and all pixels those of its calibration: the
  // least-squares sigma is inflated and has a floor, at the middle of a line and for the difference of its ends.
  float sigma_inflation = 3.0F;
  float middle_floor_px = 0.25F, slope_floor_px = 0.3F;
};

inline constexpr std::size_t kMaxStripSamples = 160;  // of one side: 40 places, four across

// One line per segment, in the same order; `has_depth` tells which ones lie on measured surfaces.
//
// A plane's disparity is affine in the image. One such function is fitted to each side's strip by iteratively
// reweighted least squares and extended to the segment. Where both sides agree the line has their mean; elsewhere the
// nearer one owns the edge, since what one sees there is its outline. A side whose depth is unknown leaves the line to
// the other: sensors lose depth in the shadow beyond an outline. Lines that no side supports keep has_depth false and
// stay of use as planes through the camera. O(segments * kMaxStripSamples).
void PlaceLines(const DepthLineParams& params, const RectifiedCamera& camera, const DisparityImage& depth,
                const Segments& segments, Lines3& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_DEPTH_LINES_H_
