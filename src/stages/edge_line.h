// Which line of the image goes with a model edge as a whole.
#ifndef WIREPOSE_STAGES_EDGE_LINE_H_
#define WIREPOSE_STAGES_EDGE_LINE_H_

#include <cstdint>

#include "base/fixed_vector.h"
#include "capacities.h"
#include "stages/edge_profile.h"

namespace wirepose {

inline constexpr std::size_t kMaxSamplePeaks = 9;  // all that a profile of 8 px to each side can hold

// What the profile across one sample of a model edge shows.
struct SamplePeaks {
  FixedVector<EdgePeak, kMaxSamplePeaks> peaks;
  std::uint16_t sample = 0;  // index of the EdgeSample

  // When full, the weakest peak makes room.
  void Add(const EdgePeak& peak);
};
using EdgePeaks = FixedVector<SamplePeaks, kMaxEdgeSamples>;  // of one model edge in one image, evenly spaced

struct EdgeLineParams {
  float step_px = 2;          // between the places that are tried at each end of an edge
  float width_px = 2;         // a peak this far from a line has no vote for it; a peak on it has a whole one
  float presence = 0.5F;      // of a vote: what any peak has; the rest grows with its strength
  float far_loss = 0.7F;      // of its votes that a line loses at the end of the range
  float other_vote = 0.5F;    // what a peak of the other polarity is worth for a line
  float tolerance_px = 2.5F;  // of a sample's peak from the line
  float other_peak = 0.3F;    // what a peak of the other polarity is worth for a sample
};

// A line beside a model edge, by its offsets (px along the normals) at the edge's first and last sample.
struct EdgeLine {
  float first_px = 0, last_px = 0;
  bool brightens = false;  // along the normal

  [[nodiscard]] float At(float share) const { return first_px + share * (last_px - first_px); }
};

// The line within `range` px (at most EdgeProfile::kMaxRange) that most samples have a peak on; near ones and strong
// peaks count more. Print, shadows and other objects' edges are stronger than a faint edge of the object here and there,
// seldom all along it. `threshold` (kGradientOne): strength saturates at eight times this. A Hough transform (Duda &
// Hart 1972) over the two offsets. O(samples * (peaks + range^2 / step^2)).
EdgeLine FindEdgeLine(const EdgeLineParams& params, const EdgePeaks& edge, int range, float threshold);

// How strong and near to `at` a peak is: what makes a sample choose it. 0 beyond `reach` px.
float PeakScore(const EdgePeak& peak, float at, float reach, float threshold);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_EDGE_LINE_H_
