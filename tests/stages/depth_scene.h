// Exact depth images of planes and models, cast ray by ray in double precision.
#ifndef WIREPOSE_TESTS_STAGES_DEPTH_SCENE_H_
#define WIREPOSE_TESTS_STAGES_DEPTH_SCENE_H_

#include <functional>

#include "model_test_support.h"
#include "stages/disparity_image.h"

namespace wirepose::testing {

using dataset::DepthImage;

inline constexpr double kDepthUnitM = 1e-4;

inline RectifiedCamera DepthCamera(int width, int height, double f) {
  RectifiedCamera camera{f, 0.5 * (width - 1), 0.5 * (height - 1), kVirtualBaselineM, width, height};
  camera.has_right_image = false;
  return camera;
}

// `z` gives the depth at a pixel in metres, 0 for none.
inline DepthImage PaintDepth(int width, int height, const std::function<double(int, int)>& z) {
  DepthImage image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.pixels.push_back(static_cast<std::uint16_t>(std::floor(z(x, y) / kDepthUnitM + 0.5)));
    }
  }
  return image;
}

// Depth along the ray of pixel (u, v) to the plane n . x = c.
inline double PlaneDepth(const RectifiedCamera& camera, const Vector3d& n, double c, double u, double v) {
  return c / n.dot(Vector3d((u - camera.cx) / camera.f, (v - camera.cy) / camera.f, 1));
}

// Of the nearest triangle of the model at T; 0 where the ray misses it.
inline double ModelDepth(const RectifiedCamera& camera, const ModelView& model, const Pose& T, double u, double v) {
  const Vector3d ray((u - camera.cx) / camera.f, (v - camera.cy) / camera.f, 1);
  double nearest = 0;
  for (const ModelTriangle& t : model.triangles) {
    const Vector3d a = T * model.VertexPosition(t.vertex[0]).cast<double>();
    const Vector3d b = T * model.VertexPosition(t.vertex[1]).cast<double>();
    const Vector3d c = T * model.VertexPosition(t.vertex[2]).cast<double>();
    Matrix3d M;
    M << b - a, c - a, -ray;
    if (std::abs(M.determinant()) < 1e-12) continue;
    const Vector3d s = M.inverse() * -a;
    if (s.x() < 0 || s.y() < 0 || s.x() + s.y() > 1 || s.z() <= 0) continue;
    if (nearest == 0 || s.z() < nearest) nearest = s.z();
  }
  return nearest;
}

// The model before a wall.
inline DepthImage ModelBeforeWall(const RectifiedCamera& camera, const ModelView& model, const Pose& T, double wall) {
  return PaintDepth(camera.width, camera.height, [&](int x, int y) {
    const double z = ModelDepth(camera, model, T, x, y);
    return z > 0 ? z : wall;
  });
}

inline std::unique_ptr<DisparityImage> DisparitiesOf(const RectifiedCamera& camera, const DepthImage& depth) {
  auto out = std::make_unique<DisparityImage>();
  auto identity = std::make_unique<Rectification>();
  DepthCalibration calibration{{camera.f, camera.f, camera.cx, camera.cy}, camera.width, camera.height};
  if (!ComputeUndistortion(calibration, *identity)) throw std::runtime_error("no such camera");
  FillDisparityImage({}, camera, identity->left, {depth.view(), static_cast<float>(kDepthUnitM)}, *out);
  return out;
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_STAGES_DEPTH_SCENE_H_
