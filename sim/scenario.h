// One random scene of a scenario: what there is to see, and how the camera moves through it.
#ifndef WIREPOSE_SIM_SCENARIO_H_
#define WIREPOSE_SIM_SCENARIO_H_

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/scenario_spec.h"
#include "sim/scene.h"
#include "sim/stereo_shot.h"
#include "sim/target_mesh.h"

namespace wirepose::sim {

struct Motion {
  PathKind kind = PathKind::kStill;
  double speed_m_per_s = 0;
  double shake_rad = 0;
  std::uint64_t seed = 0;  // of the shaking
};

struct Scenario {
  Scene scene;
  StereoRig rig;                        // at time 0
  Vector3d look_at = Vector3d::Zero();  // world; orbits turn about it, drives go towards it
  Motion motion;

  // The rig `time_s` after the start, with its velocities.
  [[nodiscard]] StereoRig RigAt(double time_s) const;
};

// Draws a scene: room, lights, objects, clutter, camera. Draws again, up to 60 times, until every
// object is as visible as the specification wants, and keeps the nearest. The same arguments give
// the same scene. The error is one line: a model that is not among the targets.
[[nodiscard]] Result<Scenario, std::string> MakeScenario(const ScenarioSpec& spec, std::uint64_t seed,
                                                         const std::vector<TargetMesh>& targets);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SCENARIO_H_
