// Stage 3: line sets of the image (paper section 3.1).
#ifndef WIREPOSE_STAGES_LINE_SETS_H_
#define WIREPOSE_STAGES_LINE_SETS_H_

#include <array>
#include <cstdint>

#include "base/fixed_vector.h"
#include "base/keep_best.h"
#include "model/model_format.h"
#include "stages/stereo_lines.h"

namespace wirepose {

struct LineSetParams {
  float junction_px = 14;          // end points nearer than this in the image form a junction
  float parallel_rad = 0.18F;      // delta_phi: lines closer in direction than this plus their sigmas are parallel
  float max_reach_m = 2.0F;        // lines farther apart belong to no common object; set to the largest model diameter
  float min_depth_length_px = 12;  // of a base line
  float junction_gain = 2.7F;      // factor on the quality of lines that meet
};

// Which ends of two lines meet.
enum class LineEnd : std::uint8_t { kA = 0, kB = 1, kNone = 2 };

// One member of a line set with its share of the parameter vector V (eq. 1-7) relative to the base line, and how well
// V is known: limits are never fixed numbers but multiples of the lines' own sigma.
struct ImageLinePair {
  std::uint16_t base = 0;   // a line with depth
  std::uint16_t other = 0;  // with depth if `metric`
  LineSetKind kind = LineSetKind::kIntersecting;
  bool metric = false;                // false: a 2D constraint; only the junction is known, V's numbers are not
  LineEnd base_end = LineEnd::kNone;  // of a junction
  LineEnd other_end = LineEnd::kNone;
  float angle_rad = 0;  // delta_phi or phi, 0..pi/2
  float angle_sigma_rad = 0;
  float distance_m = 0;  // lambda, between the infinite lines
  float distance_sigma_m = 0;
  float farthest_end_m = 0;                           // rho or theta
  float log_angle_sigma = 0, log_distance_sigma = 0;  // as the rank of corresponding pairs takes them (pair_rank.h)
  float quality = 0;                                  // long lines near each other are more likely of one object
};

// A pair before it is measured: all that the choice of pairs needs.
struct RankedImagePair {
  float quality = 0;
  std::uint16_t base = 0, other = 0;
};

struct BetterImagePair {
  bool operator()(const RankedImagePair& p, const RankedImagePair& q) const {
    if (p.quality != q.quality) return p.quality > q.quality;
    return p.base != q.base ? p.base < q.base : p.other < q.other;
  }
};

// All pairs, grouped by base line: the set of base line b is pairs [first[b], first[b + 1]), by falling quality.
struct ImageLineSets {
  KeepBest<RankedImagePair, kMaxImageLinePairs, BetterImagePair> kept;  // work space: unordered
  FixedVector<ImageLinePair, kMaxImageLinePairs> pairs;
  std::array<std::uint16_t, kMaxSegments + 1> first{};
  std::uint32_t dropped = 0;

  [[nodiscard]] std::span<const ImageLinePair> OfBase(std::size_t base) const {
    return {pairs.data() + first[base], pairs.data() + first[base + 1]};
  }
};
static_assert(kMaxImageLinePairs <= 0xFFFF);

// Every line with depth becomes a base line; its members are the lines with depth within reach, parallel or not, and
// the lines without depth that meet it at a junction. Of too many pairs those are kept that are most likely two edges
// of one object, large or small, near or far: by the product of both lengths over the square of the distance of their
// farthest ends, all in pixels, and more when they meet. `dropped` counts those that were made and given up, not those
// that could not have ranked at all. O(lines^2 log pairs).
void FindLineSets(const LineSetParams& params, const RectifiedCamera& camera, const Lines3& lines, ImageLineSets& out);

// Standard deviation of a line's direction, from the disparity covariance; pi/2 at most.
float DirectionSigma(const RectifiedCamera& camera, const Line3& line);
// Standard deviation of depth at the middle of the line, m.
float DepthSigma(const RectifiedCamera& camera, const Line3& line);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_LINE_SETS_H_
