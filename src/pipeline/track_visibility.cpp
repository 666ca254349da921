#include "pipeline/track_visibility.h"

#include <algorithm>

namespace wirepose {
namespace {

constexpr double kNear_m = 0.05;

bool IsInside(const Vector2& p, const Vector2& low, const Vector2& high) {
  return p.x() >= low.x() && p.y() >= low.y() && p.x() < high.x() && p.y() < high.y();
}

}  // namespace

bool OccluderAt(const TrackingScene& scene, const PreparedModel& model, const Pose& T_raw_model, Occluder& out) {
  const Pose T = scene.T_rectified_raw * T_raw_model;
  out.low.setConstant(1e6F);
  out.high.setConstant(-1e6F);
  for (const Vector3& corner : model.corners) {
    const Vector3d p = T * corner.cast<double>();
    if (p.z() < kNear_m) return false;
    const Vector2 image = scene.camera.Project(p).head<2>().cast<float>();
    out.low = out.low.cwiseMin(image);
    out.high = out.high.cwiseMax(image);
  }
  out.depth_m = (T * model.centre.cast<double>()).z();
  out.radius_m = 0.5 * static_cast<double>(model.view.diameter_m);
  return true;
}

float VisibleShare(const TrackingScene& scene, const PreparedModel& model, const Pose& T_raw_model,
                   std::span<const Occluder> occluders) {
  const Pose T = scene.T_rectified_raw * T_raw_model;
  Vector2 low = Vector2::Zero();
  Vector2 high(static_cast<float>(scene.camera.width), static_cast<float>(scene.camera.height));
  if (!scene.region.Whole()) {
    // Of the raw image; the rectified one differs by the lens's distortion.
    low = {static_cast<float>(scene.region.x), static_cast<float>(scene.region.y)};
    high = {low.x() + static_cast<float>(scene.region.width), low.y() + static_cast<float>(scene.region.height)};
  }
  const double depth = (T * model.centre.cast<double>()).z();
  int visible = 0;
  const auto look = [&](const Vector3& point) {
    const Vector3d p = T * point.cast<double>();
    if (p.z() < kNear_m) return;
    const Vector2 image = scene.camera.Project(p).head<2>().cast<float>();
    const bool hidden = std::any_of(occluders.begin(), occluders.end(), [&](const Occluder& o) {
      return o.depth_m + o.radius_m < depth && IsInside(image, o.low, o.high);
    });
    if (IsInside(image, low, high) && !hidden) ++visible;
  };
  for (const Vector3& corner : model.corners) look(corner);
  look(model.centre);
  return static_cast<float>(visible) / 9;
}

}  // namespace wirepose
