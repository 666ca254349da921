// Stage 1b: straight 2D segments from edge ridges.
#ifndef WIREPOSE_STAGES_SEGMENTS_H_
#define WIREPOSE_STAGES_SEGMENTS_H_

#include "base/fixed_vector.h"
#include "geometry/segment2.h"
#include "stages/edge_image.h"

namespace wirepose {

struct SegmentParams {
  float min_length_px = 12;
  float max_deviation_px = 1.1F;  // a chain bends where a point lies farther from its chord
  float max_rms_px = 0.6F;        // worse fits are curves
  float min_cosine = 0.87F;       // gradient directions of neighbours in a chain: 30 degrees
  // Collinear pieces of one edge are joined across gaps of up to this share of their lengths.
  float max_gap_share = 0.35F;
  float join_offset_px = 1.0F;
  float join_angle_rad = 0.06F;
};

// Work space; contents have no meaning between calls.
struct SegmentScratch {
  struct Point {
    float x, y, weight;  // sub-pixel ridge position and gradient magnitude
  };
  std::array<std::uint32_t, kMaxChain> chain;
  std::array<Point, kMaxChain> points;
};

struct Segments {
  FixedVector<Segment2, kMaxSegments> items;  // by falling length
  std::uint32_t dropped = 0;
};

// Ridge pixels are chained along the edge from the strongest on (edge drawing: Akinlar & Topal 2011), chains are split
// where they bend, pieces are fitted by gradient-weighted principal axes of sub-pixel ridge positions (the weights of
// LSD: Grompone von Gioi et al. 2012), and collinear neighbours of equal polarity are joined. Consumes `edges.ridge`:
// used pixels are marked 0. O(ridge pixels + segments^2).
void FindSegments(const SegmentParams& params, EdgeImage& edges, SegmentScratch& scratch, Segments& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_SEGMENTS_H_
