// How much of a predicted object the camera should see.
#ifndef WIREPOSE_PIPELINE_TRACK_VISIBILITY_H_
#define WIREPOSE_PIPELINE_TRACK_VISIBILITY_H_

#include <span>

#include "pipeline/tracker.h"

namespace wirepose {

// The rectangle around an object in the rectified left image, and its depth.
struct Occluder {
  Vector2 low = Vector2::Zero(), high = Vector2::Zero();  // px
  double depth_m = 0;                                     // of the box centre
  double radius_m = 0;                                    // half the diameter
};

// False when the object is not wholly in front of the camera.
[[nodiscard]] bool OccluderAt(const TrackingScene& scene, const PreparedModel& model, const Pose& T_raw_model,
                              Occluder& out);

// Share of the box's corners and centre that lie in the image, in the region searched, and not behind an occluder;
// 0..1. Rough: it weights what a missed detection means. O(occluders).
[[nodiscard]] float VisibleShare(const TrackingScene& scene, const PreparedModel& model, const Pose& T_raw_model,
                                 std::span<const Occluder> occluders);

}  // namespace wirepose

#endif  // WIREPOSE_PIPELINE_TRACK_VISIBILITY_H_
