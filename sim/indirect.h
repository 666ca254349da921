// Light that comes from other surfaces, once reflected: sampled on a coarse grid of the image and
// smoothed along the surfaces. Used inside this room only.
#ifndef WIREPOSE_SIM_INDIRECT_H_
#define WIREPOSE_SIM_INDIRECT_H_

#include <cstdint>
#include <vector>

#include "sim/lens.h"
#include "sim/shading.h"

namespace wirepose::sim {

struct Camera;

class IndirectLight {
 public:
  static constexpr int kStep = 3;   // px between grid places
  static constexpr int kRays = 16;  // sent out from each

  // Traces the grid over the image and `margin` pixels around it. The result does not depend on
  // `threads`. O(pixels / kStep^2 * kRays).
  IndirectLight(const Shader& shader, const Camera& camera, int margin, int threads, std::uint64_t seed);

  // Radiance of a white surface at this place, which the camera sees at `pixel`. Surfaces that no
  // grid place nearby has met get the scene's ambient light.
  [[nodiscard]] float At(const Vector2d& pixel, const SurfacePoint& surface) const;

 private:
  struct Place {
    int instance = RayScene::kNothing;
    Vector3 place = Vector3::Zero(), normal = Vector3::Zero();
    float light = 0;
  };

  [[nodiscard]] const Place& Get(int x, int y) const {
    return places_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
  }
  [[nodiscard]] Place Gather(const Camera& camera, const Lens& lens, int x, int y, std::uint64_t hash) const;
  [[nodiscard]] std::vector<float> Smoothed(int gap, int threads) const;

  const Shader& shader_;
  int margin_;
  int width_, height_;  // of the grid
  std::vector<Place> places_;
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_INDIRECT_H_
