// Who is who: the assignment of least cost.
#ifndef WIREPOSE_PIPELINE_ASSIGNMENT_H_
#define WIREPOSE_PIPELINE_ASSIGNMENT_H_

#include <array>
#include <cstddef>

#include "base/fixed_vector.h"
#include "capacities.h"

namespace wirepose {

// Cost of detection d being track t; kNoMatch where it cannot be.
struct MatchCosts {
  static constexpr double kNoMatch = 1e6;
  static constexpr double kUnmatched = 220;  // of a detection that is no track
  std::array<std::array<double, kMaxTracks>, kMaxDetections> cost;
  std::size_t detections = 0, tracks = 0;
};

inline constexpr std::size_t kNoTrack = kMaxTracks;

// Track of each detection or kNoTrack, no track twice, so that the sum of costs is least. Shortest augmenting paths
// with potentials (Kuhn 1955, Jonker and Volgenant 1987). Costs lie within
// +-1000. O(detections^2 * (detections + tracks)).
[[nodiscard]] FixedVector<std::size_t, kMaxDetections> AssignTracks(const MatchCosts& costs);

}  // namespace wirepose

#endif  // WIREPOSE_PIPELINE_ASSIGNMENT_H_
