// What there is to see: textured meshes, lights. World frame: z up, metres.
#ifndef WIREPOSE_SIM_SCENE_H_
#define WIREPOSE_SIM_SCENE_H_

#include <string>
#include <vector>

#include "sim/mesh.h"
#include "sim/texture.h"

namespace wirepose::sim {

struct Instance {
  int mesh = 0;  // index into Scene::meshes
  Pose T_world_object;
  Material material;
  int obj_id = 0;    // of a target object, from 1; 0: background or distractor, which has no truth
  std::string name;  // of a target object
};

// A rectangle that shines to one side; it casts soft shadows and is not itself seen.
struct AreaLight {
  Vector3 centre = Vector3::Zero();
  Vector3 half_u = Vector3::Zero(),
          half_v = Vector3::Zero();  // from the centre to the middle of two sides
  // Radiance of a white surface that faces the whole light from 1 m, in units of the sensor's full
  // scale.
  float intensity = 1;
};

struct Scene {
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<AreaLight> lights;
  // Light from everywhere: radiance of a white surface facing up and of one facing down.
  float ambient_up = 0.3F, ambient_down = 0.15F;
  float background = 0;  // radiance where nothing is
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SCENE_H_
