// Local normalisation: what stereo matching compares.
#ifndef WIREPOSE_STAGES_NORMALIZE_H_
#define WIREPOSE_STAGES_NORMALIZE_H_

#include <array>
#include <cstdint>

#include "base/image_view.h"
#include "capacities.h"

namespace wirepose {

using NormalizedPlane = std::array<std::uint8_t, kMaxPixels>;  // stride kMaxImageWidth, 128: local mean

// out = 128 + kGain * (I - mean) / (deviation + kNoiseFloor), clipped to 0..255, so that exposure, gain and shading
// that differ between the two cameras cancel (a real pair differs by a factor of 0.66). Mean and deviation are those of
// the 14 x 14 pixels around each block of 2 x 2. The noise floor keeps flat areas flat. O(pixels), running sums.
void NormalizeLocally(ImageView image, NormalizedPlane& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_NORMALIZE_H_
