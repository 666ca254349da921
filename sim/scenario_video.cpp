#include "sim/scenario_video.h"

#include <cmath>
#include <utility>

#include "sim/random.h"

namespace wirepose::sim {

Result<ScenarioVideo, std::string> ScenarioVideo::Create(const ScenarioSpec& spec, int scene,
                                                         const std::vector<TargetMesh>& targets, int threads) {
  if (!(spec.rate_hz >= 1 && spec.rate_hz <= 1000)) {
    return unexpected<std::string>("simulator: frame rate is not in 1..1000 Hz; give 30");
  }
  const int side = static_cast<int>(std::lround(std::sqrt(std::max(spec.samples, 0))));
  if (side * side != spec.samples || side < 2 || side > 6) {
    return unexpected<std::string>("simulator: samples per pixel are not 4, 9, 16, 25 or 36; give 16");
  }
  if (threads < 1 || threads > 64) {
    return unexpected<std::string>("simulator: threads are not in 1..64; give 2");
  }
  const std::uint64_t seed = spec.seed + static_cast<std::uint64_t>(scene);
  Result<Scenario, std::string> scenario = MakeScenario(spec, seed, targets);
  if (!scenario) return unexpected(scenario.error());
  return ScenarioVideo(spec, seed, threads, *std::move(scenario));
}

ScenarioVideo::ScenarioVideo(const ScenarioSpec& spec, std::uint64_t seed, int threads, Scenario scenario)
    : rate_hz_(spec.rate_hz),
      options_{static_cast<int>(std::lround(std::sqrt(spec.samples))), threads, 1, true},
      seed_(seed),
      scenario_(std::make_unique<Scenario>(std::move(scenario))),
      renderer_(std::make_unique<Renderer>(scenario_->scene)) {}

StereoRig ScenarioVideo::RigAt(std::uint64_t sequence) const {
  return scenario_->RigAt(static_cast<double>(sequence) / rate_hz_);
}

StereoShot ScenarioVideo::Shoot(std::uint64_t sequence, const ShotChange& change) const {
  RenderOptions options = options_;
  options.seed = Mix(seed_, sequence);
  const double time_s = static_cast<double>(sequence) / rate_hz_;
  StereoRig left = scenario_->RigAt(time_s), right = scenario_->RigAt(time_s + change.right_lag_s);
  const Matrix3d turn = Eigen::AngleAxisd(change.drift_rad, Vector3d::UnitY()).toRotationMatrix();
  right.calibration.T_right_left = Pose{turn, Vector3d::Zero()} * right.calibration.T_right_left;
  left.light = right.light = static_cast<float>(change.light);
  return ShootStereo(*renderer_, left, right, options);
}

}  // namespace wirepose::sim
