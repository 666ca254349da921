// From a scene to the light that falls on one sensor: ray tracing with direct light, soft shadows
// and a blurring lens.
#ifndef WIREPOSE_SIM_RENDERER_H_
#define WIREPOSE_SIM_RENDERER_H_

#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "sim/ray_scene.h"
#include "sim/scene.h"

namespace wirepose::sim {

struct Camera {
  CameraIntrinsics intrinsics;
  int width = 0, height = 0;  // px
  Pose T_world_camera;
  // Standard deviation of the lens's Gaussian point spread, px; the pixel's own square comes on
  // top. At most 2.
  double psf_sigma_px = 0.5;
};

struct RenderOptions {
  int samples_per_side = 4;  // per pixel the square of this, 2..6
  int threads = 2;
  std::uint64_t seed = 1;  // of the samples' places; not of the scene
};

// Radiance in units of the sensor's full scale, row-major.
struct RadianceImage {
  int width = 0, height = 0;
  std::vector<float> pixels;

  [[nodiscard]] float operator()(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

// Owns a scene and its acceleration structure. Render is const and may run on many threads. Results
// do not depend on the number of threads; on another kind of processor the last bits may differ,
// because Embree chooses its kernels by it.
class Renderer {
 public:
  explicit Renderer(Scene scene);

  // O(pixels * samples). Surfaces are matt; light comes from the lights and the ambient term, none
  // bounces.
  [[nodiscard]] RadianceImage Render(const Camera& camera, const RenderOptions& options) const;

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const RayScene& rays() const { return rays_; }
  // Bounding box of instance `i` in its own frame.
  [[nodiscard]] const Bounds& bounds(std::size_t i) const { return bounds_[i]; }

 private:
  Scene scene_;
  RayScene rays_;
  std::vector<Bounds> bounds_;  // one an instance
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_RENDERER_H_
