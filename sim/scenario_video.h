// One scene of a scenario as a stream of numbered stereo frames: what the simulated camera gives
// and `wirepose sim` writes.
#ifndef WIREPOSE_SIM_SCENARIO_VIDEO_H_
#define WIREPOSE_SIM_SCENARIO_VIDEO_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/scenario.h"

namespace wirepose::sim {

// What a fault does to the rig for one frame.
struct ShotChange {
  double right_lag_s = 0;  // the right eye is exposed later
  double drift_rad = 0;    // the right camera is turned about its y axis against the calibration
  double light = 1;        // times the exposure

  friend bool operator==(const ShotChange&, const ShotChange&) = default;
};

// Frames may be shot in any order and on any thread; each is a pure function of specification,
// scene, targets and number.
class ScenarioVideo {
 public:
  // `scene` counts from 0. `threads` does not change a byte. The error is one line: an option out
  // of range, or see MakeScenario.
  [[nodiscard]] static Result<ScenarioVideo, std::string> Create(const ScenarioSpec& spec, int scene,
                                                                 const std::vector<TargetMesh>& targets,
                                                                 int threads = 2);

  [[nodiscard]] StereoRig RigAt(std::uint64_t sequence) const;
  [[nodiscard]] StereoShot Shoot(std::uint64_t sequence, const ShotChange& change = {}) const;

  [[nodiscard]] const StereoCalibration& calibration() const { return scenario_->rig.calibration; }
  [[nodiscard]] const Scenario& scenario() const { return *scenario_; }

 private:
  ScenarioVideo(const ScenarioSpec& spec, std::uint64_t seed, int threads, Scenario scenario);

  double rate_hz_;
  RenderOptions options_;
  std::uint64_t seed_;
  std::unique_ptr<Scenario> scenario_;
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SCENARIO_VIDEO_H_
