// Part of stage 2: where the strips beside a segment are seen in the right image.
#ifndef WIREPOSE_STAGES_STRIP_SEARCH_H_
#define WIREPOSE_STAGES_STRIP_SEARCH_H_

#include "stages/stereo_lines.h"

namespace wirepose {

// A row that the segment crosses.
struct RowSample {
  int y;
  float x;  // of the edge, sub-pixel
  float t;  // position along the segment: 0 at a, 1 at b
};
using RowSamples = FixedVector<RowSample, kMaxImageHeight>;

// Every row between the end points, or `limit` of them evenly spread.
RowSamples CrossedRows(const Segment2& s, int limit);

// Disparities of a strip at the ends of its segment, px, to the whole pixel.
struct StripMatch {
  float disparity_a = 0, disparity_b = 0;
  float cost = 0;        // per row, SAD of 7 px
  float cost_ratio = 1;  // best over best elsewhere
  bool found = false;
};

// The strips on both sides of a segment; `bright` is the side that its normal points to. A steep one is compared row by
// row. Not found where the strip is outside of an image. No heap.
// O(kMaxStereoRows * kMaxDisparity * slopes).
void MatchSteep(const StereoLineParams& params, const StereoInput& in, const Segment2& segment, StereoScratch& scratch,
                StripMatch& bright, StripMatch& dark);

// The same for a segment along the rows: samples along it and a little past both ends.
void MatchFlat(const StereoLineParams& params, const StereoInput& in, const Segment2& segment, StereoScratch& scratch,
               StripMatch& bright, StripMatch& dark);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_STRIP_SEARCH_H_
