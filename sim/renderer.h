// From a scene to the light that falls on one sensor: ray tracing with direct and once reflected
// light, soft shadows, gloss, a moving camera and a blurring lens.
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
  double vignetting = 0;  // share of the light that is lost in the corners, 0..0.9

  // Motion during the exposure, in the world; T_world_camera is the pose in its middle.
  double exposure_s = 0;
  Vector3d velocity = Vector3d::Zero();       // m/s
  Vector3d rotation_rate = Vector3d::Zero();  // rad/s
};

struct RenderOptions {
  int samples_per_side = 4;  // per pixel the square of this, 2..6
  int threads = 2;
  std::uint64_t seed = 1;  // of the samples' places; not of the scene
  // Light between surfaces is traced; without, the scene's ambient light stands for it.
  bool is_indirect = false;
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
  // Halts on a scene with more than 16 lights.
  explicit Renderer(Scene scene);

  // O(pixels * samples).
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
