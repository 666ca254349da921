// Stage 2b: a coarse dense disparity map: where surfaces are, between the lines.
#ifndef WIREPOSE_STAGES_DISPARITY_MAP_H_
#define WIREPOSE_STAGES_DISPARITY_MAP_H_

#include <array>
#include <cstdint>

#include "capacities.h"
#include "stages/normalize.h"

namespace wirepose {

// Disparity of every second pixel of every second row of the rectified left image; kRowStep rows are alike.
struct DisparityMap {
  static constexpr int kScale = 2;
  static constexpr int kMaxWidth = kMaxImageWidth / kScale, kMaxHeight = kMaxImageHeight / kScale;
  static constexpr float kOne = 8;              // stored units a pixel
  static constexpr std::uint16_t kUnknown = 0;  // unconfirmed, or hidden in the right image

  int width = 0, height = 0;                                                 // of the map: the image's halved
  std::array<std::uint16_t, std::size_t{kMaxWidth} * kMaxHeight> disparity;  // kOne a pixel of the full image

  // Disparity [px of the full image] at full image coordinates inside the image; 0 where unknown.
  [[nodiscard]] float At(int x, int y) const {
    const int i = x / kScale < width ? x / kScale : width - 1;
    const int j = y / kScale < height ? y / kScale : height - 1;
    return static_cast<float>(disparity[static_cast<std::size_t>(j * kMaxWidth + i)]) / kOne;
  }
};

// Costs must fit into bytes: small_step is at most 40, 9 max_difference + large_step at most 214.
struct DisparityMapParams {
  std::uint8_t small_step = 22;      // cost of a change by one between neighbours, beside sums of 3 x 3 differences ...
  std::uint8_t large_step = 88;      // ... and of any larger change
  std::uint8_t max_difference = 12;  // of two normalised values, in steps of kDifferenceStep: more says no more
  int max_asymmetry = 1;             // between the maps of both images, half pixels
};

inline constexpr int kMapDisparities = 80;  // half pixels: surfaces from 0.4 m at f*B = 63 px*m
// Every second row of the map is matched and stands for the next one too: half the time, the same recognition.
inline constexpr int kRowStep = 2;

// Differences of normalised values are counted in steps: so the costs of a path fit into bytes.
inline constexpr int kDifferenceStep = 8;

// Work space; contents have no meaning between calls.
struct DisparityScratch {
  static constexpr int kWidth = DisparityMap::kMaxWidth, kDepth = kMapDisparities;
  using Row = std::array<std::uint8_t, kWidth>;
  using Path = std::array<std::uint8_t, kDepth + 2>;  // a guard before the first disparity and after the last

  std::array<std::array<std::uint8_t, std::size_t{kWidth} * kDepth>, 3> difference;  // of three rows of pixels
  std::array<std::uint8_t, std::size_t{kWidth} * kDepth> cost;                       // summed over 3 x 3 pixels
  // Path costs of the row at work: from the left, from the right, and from above with those of the row before.
  std::array<Path, kWidth> from_left, from_right;
  std::array<std::array<Path, kWidth>, 2> above;
  std::array<std::uint8_t, kWidth> above_lowest;
  std::array<std::array<std::uint16_t, kWidth>, 2> best_right;  // lowest cost and its disparity in the right image
  std::array<std::uint16_t, kWidth> best_left;
  std::array<std::uint16_t, std::size_t{kWidth} * ((DisparityMap::kMaxHeight + kRowStep - 1) / kRowStep)>
      raw;  // before speckles are dropped
};

// Semi-global matching (Hirschmueller 2008) at half resolution on locally normalised images, along three paths (from
// the left, from the right, from above), so that a few rows of memory suffice; matches that the right image or the
// neighbours do not confirm are unknown. Integers only. O(pixels / (4 kRowStep) * kMapDisparities * 3).
void ComputeDisparityMap(const DisparityMapParams& params, int width, int height, const NormalizedPlane& left,
                         const NormalizedPlane& right, DisparityScratch& scratch, DisparityMap& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_DISPARITY_MAP_H_
