// The frames of a simulated stream, one after the other: kept in memory, kept on disk, or rendered. Used inside this
// room only.
#ifndef WIREPOSE_HAL_SIMULATED_FRAME_SOURCE_H_
#define WIREPOSE_HAL_SIMULATED_FRAME_SOURCE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hal/simulated/frame_cache.h"
#include "sim/scenario_spec.h"
#include "sim/scenario_video.h"

namespace wirepose::hal {

// Belongs to one thread.
class FrameSource {
 public:
  // `loop_frames` above zero: as many frames are kept in memory and given out over and over.
  FrameSource(const sim::ScenarioSpec& spec, sim::ScenarioVideo video, std::optional<FrameCache> cache,
              std::size_t loop_frames)
      : spec_(spec), video_(std::move(video)), cache_(std::move(cache)), loop_(loop_frames) {}

  [[nodiscard]] const StereoCalibration& calibration() const { return video_.calibration(); }

  // True when frames may come faster than they are rendered: they have to be held back to the camera's pace.
  [[nodiscard]] bool keeps_frames() const { return cache_.has_value() || !loop_.empty(); }

  // Forgets the frame before: a stream begins.
  void Restart() { last_ = {}; }

  // Frame `sequence` with all that is planned for it, faults included; valid until the next call. The error, one line,
  // names the file that could not be written.
  Result<const CachedFrame*, std::string> Make(std::uint64_t sequence, const FramePlan& plan);

 private:
  Result<CachedFrame, std::string> FromMemory(std::uint64_t sequence, const sim::ShotChange& change);
  Result<CachedFrame, std::string> LoadOrShoot(std::uint64_t sequence, const sim::ShotChange& change);

  sim::ScenarioSpec spec_;
  sim::ScenarioVideo video_;
  std::optional<FrameCache> cache_;
  std::vector<std::optional<CachedFrame>> loop_;  // empty: no loop
  CachedFrame last_;                              // as given out
};

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_SIMULATED_FRAME_SOURCE_H_
