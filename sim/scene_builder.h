// Draws of random numbers and a hand to put things into a scene with. Used inside this room only.
#ifndef WIREPOSE_SIM_SCENE_BUILDER_H_
#define WIREPOSE_SIM_SCENE_BUILDER_H_

#include <cmath>
#include <vector>

#include "sim/random.h"
#include "sim/scenario_spec.h"
#include "sim/scene.h"

namespace wirepose::sim {

inline double Draw(Random& random, const Range& range) { return random.Uniform(range.low, range.high); }
inline float DrawFloat(Random& random, const Range& range) { return static_cast<float>(Draw(random, range)); }
// A whole number, both ends included.
inline int DrawCount(Random& random, const Range& range) {
  return static_cast<int>(std::floor(random.Uniform(range.low, range.high + 1)));
}
inline std::uint32_t DrawSeed(Random& random) { return static_cast<std::uint32_t>(random.Next()); }

template <typename T>
const T& DrawOne(Random& random, const std::vector<T>& from) {
  return from[static_cast<std::size_t>(random.Below(static_cast<int>(from.size())))];
}

// An albedo that differs from its surroundings by at least 0.15.
inline float StandOut(Random& random, float surroundings) {
  for (int i = 0; i < 50; ++i) {
    const float albedo = DrawFloat(random, {0.12, 0.85});
    if (std::abs(albedo - surroundings) > 0.15F) return albedo;
  }
  return surroundings > 0.5F ? 0.2F : 0.8F;
}

// Adds meshes with poses to a scene, which must outlive it.
class SceneBuilder {
 public:
  explicit SceneBuilder(Scene& scene) : scene_(scene) {}

  // The reference is valid until the next call.
  Instance& Add(const Mesh& mesh, const Pose& T_world_object, const Material& material) {
    scene_.meshes.push_back(mesh);
    Instance instance;
    instance.mesh = static_cast<int>(scene_.meshes.size()) - 1;
    instance.T_world_object = T_world_object;
    instance.material = material;
    scene_.instances.push_back(instance);
    return scene_.instances.back();
  }

  // A box between two corners.
  void AddSlab(const Vector3d& low, const Vector3d& high, const Material& material) {
    Pose T;
    T.t = 0.5 * (low + high);
    Add(MakeBox((high - low).cast<float>()), T, material);
  }

  [[nodiscard]] Scene& scene() { return scene_; }

 private:
  Scene& scene_;
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SCENE_BUILDER_H_
