// How much light a place on a surface sends towards a viewer. Used inside this room only.
#ifndef WIREPOSE_SIM_SHADING_H_
#define WIREPOSE_SIM_SHADING_H_

#include <cstdint>
#include <vector>

#include "sim/ray_scene.h"
#include "sim/scene.h"

namespace wirepose::sim {

struct SurfacePoint {
  Vector3 place = Vector3::Zero();   // world, m
  Vector3 normal = Vector3::Zero();  // unit, towards the viewer
  float albedo = 0;
  float mirrored = 0;   // share of the light that is reflected as by a mirror (Schlick 1994)
  float roughness = 0;  // of that mirror
  int instance = RayScene::kNothing;
};

// One point of one light as seen from a surface. Its radiance stands for all lights: the mean over
// random points is what a white surface sends out.
struct LightSample {
  Vector3 start = Vector3::Zero();     // a little above the surface
  Vector3 to_light = Vector3::Zero();  // m
  float radiance = 0;                  // of a white matt surface, unless something is between
};

// Reads scene and rays, which must outlive it. Const methods may run on many threads.
class Shader {
 public:
  Shader(const Scene& scene, const RayScene& rays, const std::vector<Bounds>& bounds);

  // `direction` is the viewing ray's, `normal` any normal of the surface there.
  [[nodiscard]] SurfacePoint At(int instance, const Vector3& place, const Vector3& normal,
                                const Vector3& direction) const;

  // `pick` and `across` in [0, 1) choose light and point; evenly spread pairs give little noise.
  // O(lights).
  [[nodiscard]] LightSample SampleLight(const SurfacePoint& surface, float pick, float across) const;

  // Highlight of a light: radiance towards `direction`'s origin for a light sample of radiance 1
  // (Blinn 1977, normalised).
  [[nodiscard]] static float Highlight(const SurfacePoint& surface, const Vector3& direction, const Vector3& to_light);

  // Light from everywhere on a white surface.
  [[nodiscard]] float Ambient(const Vector3& normal) const;

  // Radiance that arrives along one ray, with direct and ambient light only. `hash` chooses the
  // light sample.
  [[nodiscard]] float Radiance(const Vector3& origin, const Vector3& direction, std::uint64_t hash) const;

  // What a glossy surface mirrors, blurred by its roughness.
  [[nodiscard]] float Reflection(const SurfacePoint& surface, const Vector3& direction, std::uint64_t hash) const;

  [[nodiscard]] const RayScene& rays() const { return rays_; }

 private:
  struct Frame {
    Matrix3 R_object_world = Matrix3::Identity();
    Vector3 origin = Vector3::Zero();
  };

  const Scene& scene_;
  const RayScene& rays_;
  const std::vector<Bounds>& bounds_;
  std::vector<Frame> frames_;   // one an instance
  std::vector<Vector3> shine_;  // one a light: the unit direction it shines to
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SHADING_H_
