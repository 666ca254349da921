// Small worlds for the simulator's tests.
#ifndef WIREPOSE_TESTS_SIM_TEST_SCENES_H_
#define WIREPOSE_TESTS_SIM_TEST_SCENES_H_

#include <vector>

#include "sim/random.h"
#include "sim/scene.h"
#include "sim/stereo_shot.h"
#include "sim/target_mesh.h"

namespace wirepose::sim::test {

// A quarter of the resolution of the default rig, otherwise the same: fast to render.
inline StereoCalibration SmallCalibration(double scale = 0.25) {
  StereoCalibration c = DefaultCalibration();
  c.width = static_cast<int>(c.width * scale);
  c.height = static_cast<int>(c.height * scale);
  for (CameraIntrinsics* eye : {&c.left, &c.right}) {
    eye->fx *= scale;
    eye->fy *= scale;
    eye->cx = (eye->cx + 0.5) * scale - 0.5;
    eye->cy = (eye->cy + 0.5) * scale - 0.5;
  }
  return c;
}

inline Camera LeftOf(const StereoCalibration& c) { return {c.left, c.width, c.height, Pose{}, 0.5}; }

// Any rotation, evenly enough.
inline Matrix3d AnyRotation(Random& random) {
  const Vector3d axis(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
  return Eigen::AngleAxisd(random.Uniform(-3, 3), axis.normalized()).toRotationMatrix();
}

// Glows evenly and lies in the dark: what the camera sees of it is its coverage.
inline Instance Glowing(int mesh, const Pose& T_world_object) {
  Instance instance;
  instance.mesh = mesh;
  instance.T_world_object = T_world_object;
  instance.material.albedo = 1;
  instance.material.noise = 0;
  instance.obj_id = 1;
  return instance;
}

inline Scene GlowingBox(const Vector3& size, const Pose& T_world_object) {
  Scene scene;
  scene.meshes = {MakeBox(size)};
  scene.instances = {Glowing(0, T_world_object)};
  scene.ambient_up = scene.ambient_down = 1;
  return scene;
}

inline std::vector<TargetMesh> BoxAndBook() {
  return {{1, "parcel_box", {}, MakeBox({0.3F, 0.2F, 0.15F})}, {2, "book", {}, MakeBox({0.24F, 0.165F, 0.035F})}};
}

}  // namespace wirepose::sim::test

#endif  // WIREPOSE_TESTS_SIM_TEST_SCENES_H_
