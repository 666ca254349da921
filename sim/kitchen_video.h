// A scenario as a stream of numbered stereo frames: what the simulated camera gives and `wirepose
// sim render` writes.
#ifndef WIREPOSE_SIM_KITCHEN_VIDEO_H_
#define WIREPOSE_SIM_KITCHEN_VIDEO_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/scenario.h"

namespace wirepose::sim {

struct VideoConfig {
  std::uint64_t seed = 1;  // of scenario, camera path and noise
  double frame_rate_hz = 30;
  int samples_per_side = 4;  // per pixel the square of this, 2..6
  int threads = 2;           // does not change a byte
  StereoCalibration calibration = DefaultCalibration();
};

// Frames may be shot in any order and on any thread; each is a pure function of configuration,
// targets and number.
class KitchenVideo {
 public:
  // The error is one line: an option out of range, or no target small enough.
  [[nodiscard]] static Result<KitchenVideo, std::string> Create(const VideoConfig& config,
                                                                const std::vector<TargetMesh>& targets);

  [[nodiscard]] StereoRig RigAt(std::uint64_t sequence) const;
  [[nodiscard]] StereoShot Shoot(std::uint64_t sequence) const;
  [[nodiscard]] const StereoCalibration& calibration() const { return scenario_->rig.calibration; }
  [[nodiscard]] const Scenario& scenario() const { return *scenario_; }

 private:
  KitchenVideo(const VideoConfig& config, Scenario scenario);

  VideoConfig config_;
  std::unique_ptr<Scenario> scenario_;
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_KITCHEN_VIDEO_H_
