// Ready-made worlds: a scene, the camera's path through it, and the rig.
#ifndef WIREPOSE_SIM_SCENARIO_H_
#define WIREPOSE_SIM_SCENARIO_H_

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/scene.h"
#include "sim/stereo_shot.h"
#include "sim/target_mesh.h"

namespace wirepose::sim {

struct Scenario {
  Scene scene;
  StereoRig rig;  // at time 0

  // The camera circles slowly around this place and bobs a little, always looking at it.
  Vector3d look_at = Vector3d::Zero();  // world
  double orbit_rad_per_s = 0.12;        // of a turn to and fro over +-0.3 rad

  // The rig `time_s` after the start.
  [[nodiscard]] StereoRig RigAt(double time_s) const;
};

// A kitchen counter of wood or stone with a tiled wall behind it. One to three of the targets that
// are small enough to stand there (0.6 m) rest on it, mostly unoccluded at time 0, among cartons,
// jars and cans. The camera is 0.7 to 1.4 m away and looks down by 15 to 40 degrees. The same seed
// and targets give the same scenario. The error is one line: no target is small enough.
[[nodiscard]] Result<Scenario, std::string> KitchenScenario(
    std::uint64_t seed, const std::vector<TargetMesh>& targets,
    const StereoCalibration& calibration = DefaultCalibration());

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SCENARIO_H_
