// Cameras: the raw rig as calibrated and the rectified pair that the recognizer works in.
#ifndef WIREPOSE_GEOMETRY_CAMERA_H_
#define WIREPOSE_GEOMETRY_CAMERA_H_

#include <algorithm>

#include "geometry/se3.h"

namespace wirepose {

// Pinhole with Brown-Conrady distortion, as OpenCV defines it (k1 k2 p1 p2 k3). Lengths in pixels, axes x right,
// y down, z forward, pixel centres at integer coordinates.
struct CameraIntrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
};

// Raw stereo rig. x_right = T_right_left * x_left, metres.
struct StereoCalibration {
  CameraIntrinsics left, right;
  Pose T_right_left;
  int width = 0, height = 0;
};

// One camera whose images come with a registered depth image: every pixel's z, seen through the same lens.
struct DepthCalibration {
  CameraIntrinsics camera;
  int width = 0, height = 0;
};

// Rectified pair: equal pinholes, rows aligned, x_right = x_left - (baseline, 0, 0).
// A point (x, y, z) [m] appears at u = f x/z + cx, v = f y/z + cy in the left image and at u - f*baseline/z in the
// right one: its disparity. One principal point for both, so that disparity 0 is infinity.
struct RectifiedCamera {
  double f = 0, cx = 0, cy = 0;  // px
  double baseline = 0;           // m
  int width = 0, height = 0;
  // False for a camera with depth: there is no right image, and the baseline is virtual. Depth is kept as the disparity
  // that a right camera would see, so that all stages speak of one quantity.
  bool has_right_image = true;

  [[nodiscard]] double DisparityOfDepth(double z) const { return f * baseline / z; }
  // (u, v, disparity) of a point in front of the camera (z > 0).
  [[nodiscard]] Vector3d Project(const Vector3d& p) const {
    return {f * p.x() / p.z() + cx, f * p.y() / p.z() + cy, f * baseline / p.z()};
  }
  // The point seen at (u, v) with `disparity` > 0.
  [[nodiscard]] Vector3d Triangulate(double u, double v, double disparity) const {
    const double z = f * baseline / disparity;
    return {(u - cx) * z / f, (v - cy) * z / f, z};
  }
};

// The points of a model at one pose, seen in the left image, in single precision.
class ProjectedModel {
 public:
  ProjectedModel(const RectifiedCamera& camera, const Pose& T_camera_model)
      : R_(T_camera_model.R.cast<float>()),
        t_(T_camera_model.t.cast<float>()),
        f_(static_cast<float>(camera.f)),
        centre_(static_cast<float>(camera.cx), static_cast<float>(camera.cy)) {}

  // Pixel of a point of the model; one nearer than 5 cm, or behind the camera, as if it were there.
  [[nodiscard]] Vector2 Pixel(const Vector3& point) const {
    constexpr float kMinDepthM = 0.05F;
    const Vector3 p = R_ * point + t_;
    return f_ / std::max(p.z(), kMinDepthM) * p.head<2>() + centre_;
  }
  // The camera's centre in the model's frame.
  [[nodiscard]] Vector3 Eye() const { return -(R_.transpose() * t_); }

 private:
  Matrix3 R_;
  Vector3 t_;
  float f_;
  Vector2 centre_;
};

}  // namespace wirepose

#endif  // WIREPOSE_GEOMETRY_CAMERA_H_
