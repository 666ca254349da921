// OpenCV's projection: the oracle that shares nothing with the simulator's own.
#ifndef WIREPOSE_TESTS_SIM_OPENCV_PROJECTION_H_
#define WIREPOSE_TESTS_SIM_OPENCV_PROJECTION_H_

#include <opencv2/calib3d.hpp>
#include <vector>

#include "geometry/camera.h"

namespace wirepose::sim::test {

// Where the camera sees points of its own frame.
inline std::vector<Eigen::Vector2d> ProjectWithOpenCv(const CameraIntrinsics& c, const std::vector<Vector3d>& points) {
  const cv::Matx33d K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  const std::vector<double> D{c.k1, c.k2, c.p1, c.p2, c.k3};
  std::vector<cv::Point3d> in;
  for (const Vector3d& p : points) in.emplace_back(p.x(), p.y(), p.z());
  std::vector<cv::Point2d> out;
  cv::projectPoints(in, cv::Vec3d(), cv::Vec3d(), K, D, out);
  std::vector<Eigen::Vector2d> pixels;
  for (const cv::Point2d& p : out) pixels.emplace_back(p.x, p.y);
  return pixels;
}

}  // namespace wirepose::sim::test

#endif  // WIREPOSE_TESTS_SIM_OPENCV_PROJECTION_H_
