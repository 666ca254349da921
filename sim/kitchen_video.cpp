#include "sim/kitchen_video.h"

#include <utility>

#include "sim/random.h"

namespace wirepose::sim {

Result<KitchenVideo, std::string> KitchenVideo::Create(const VideoConfig& config,
                                                       const std::vector<TargetMesh>& targets) {
  if (!(config.frame_rate_hz >= 1 && config.frame_rate_hz <= 1000)) {
    return unexpected<std::string>("simulator: frame rate is not in 1..1000 Hz; give 30");
  }
  if (config.samples_per_side < 2 || config.samples_per_side > 6) {
    return unexpected<std::string>("simulator: samples per pixel are not 4, 9, 16, 25 or 36; give 16");
  }
  if (config.threads < 1 || config.threads > 64) {
    return unexpected<std::string>("simulator: threads are not in 1..64; give 2");
  }
  Result<Scenario, std::string> scenario = KitchenScenario(config.seed, targets, config.calibration);
  if (!scenario) return unexpected(scenario.error());
  return KitchenVideo(config, *std::move(scenario));
}

KitchenVideo::KitchenVideo(const VideoConfig& config, Scenario scenario)
    : config_(config),
      scenario_(std::make_unique<Scenario>(std::move(scenario))),
      renderer_(std::make_unique<Renderer>(scenario_->scene)) {}

StereoRig KitchenVideo::RigAt(std::uint64_t sequence) const {
  return scenario_->RigAt(static_cast<double>(sequence) / config_.frame_rate_hz);
}

StereoShot KitchenVideo::Shoot(std::uint64_t sequence) const {
  const RenderOptions options{config_.samples_per_side, config_.threads, Mix(config_.seed, sequence)};
  return ShootStereo(*renderer_, RigAt(sequence), options);
}

}  // namespace wirepose::sim
