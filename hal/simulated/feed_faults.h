// What goes wrong in a simulated feed, and when. Used inside this room and by its tests.
#ifndef WIREPOSE_HAL_SIMULATED_FEED_FAULTS_H_
#define WIREPOSE_HAL_SIMULATED_FEED_FAULTS_H_

#include <chrono>
#include <cstdint>
#include <vector>

#include "hal/dataset/png_image.h"
#include "sim/scenario_spec.h"
#include "sim/scenario_video.h"

namespace wirepose::hal {

// Everything that happens to one frame.
struct FramePlan {
  bool is_dropped = false;       // never comes
  bool is_disconnected = false;  // the device is gone while it would have come
  bool repeats_last = false;     // the images of the frame given out before
  sim::ShotChange change;        // what the renderer has to know
  double told_lag_s = 0;         // of the right eye, as the stamps have it
  std::chrono::nanoseconds stamp_shift{0};
  std::vector<sim::FaultSpec> image_faults;  // for ApplyImageFaults
};

// A pure function of its arguments: `seed` is for the jitter of the right eye's lag.
[[nodiscard]] FramePlan PlanFrame(const sim::FeedSpec& feed, std::uint64_t sequence, std::uint64_t seed);

struct StereoImages {
  dataset::GrayImage left, right;
};

// Swaps, tears, flips bits, smears, covers. `last` is the pair given out before; empty before the
// first. Deterministic by `seed`.
void ApplyImageFaults(const std::vector<sim::FaultSpec>& faults, std::uint64_t seed, const StereoImages& last,
                      StereoImages& images);

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_SIMULATED_FEED_FAULTS_H_
