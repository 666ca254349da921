#include "dense_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace wirepose::bench {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kDisparities = 160;
constexpr double kMaxDepthM = 4;

bool Known(const cv::Vec3f& v) { return v[2] == v[2]; }

cv::Mat Disparity(const StereoRig::Rectified& pair) {
  constexpr int kBlock = 9;
  cv::Mat left, right, disparity;
  cv::copyMakeBorder(pair.left, left, 0, 0, kDisparities, 0, cv::BORDER_REPLICATE);  // near things at the left border
  cv::copyMakeBorder(pair.right, right, 0, 0, kDisparities, 0, cv::BORDER_REPLICATE);
  cv::GaussianBlur(left, left, {5, 5}, 1);
  cv::GaussianBlur(right, right, {5, 5}, 1);
  cv::StereoSGBM::create(0, kDisparities, kBlock, 8 * kBlock * kBlock, 32 * kBlock * kBlock, 1, 31, 8, 100, 2,
                         cv::StereoSGBM::MODE_SGBM_3WAY)
      ->compute(left, right, disparity);
  return disparity(cv::Rect(kDisparities, 0, pair.left.cols, pair.left.rows)).clone();
}

cv::Mat3f Triangulate(const StereoRig& rig, const cv::Mat& disparity) {
  cv::Mat3f points(disparity.size(), cv::Vec3f::all(kNan));
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const double d = disparity.at<std::int16_t>(y, x) / 16.0;
      if (d < rig.f_baseline / kMaxDepthM || d > x) continue;
      const double z = rig.f_baseline / d;
      points(y, x) = cv::Vec3f(cv::Vec3d((x - rig.cx) / rig.f * z, (y - rig.cy) / rig.f * z, z));
    }
  }
  return points;
}

// Normal of the points around (x, y) of the full cloud by their covariance; NaN if they are few or not plane.
cv::Vec3f NormalAt(const cv::Mat3f& points, int x, int y, double f_baseline) {
  constexpr int kHalfWindow = 8, kStep = 2, kMinPoints = 18;
  constexpr double kMaxThickness = 0.08;  // smallest over all variance
  const cv::Vec3f p = points(y, x);
  const double z = static_cast<double>(p[2]), tolerance = std::max(0.02 * z, z * z / f_baseline);
  cv::Vec3d sum(0, 0, 0);
  cv::Matx33d squares = cv::Matx33d::zeros();
  int n = 0;
  for (int v = std::max(0, y - kHalfWindow); v <= std::min(points.rows - 1, y + kHalfWindow); v += kStep) {
    for (int u = std::max(0, x - kHalfWindow); u <= std::min(points.cols - 1, x + kHalfWindow); u += kStep) {
      const cv::Vec3d d = points(v, u) - p;
      if (!(std::abs(d[2]) < tolerance)) continue;  // also what is not known
      sum += d;
      squares += d * d.t();
      ++n;
    }
  }
  if (n < kMinPoints) return cv::Vec3f::all(kNan);
  const cv::Vec3d mean = sum / n;
  const cv::Matx33d covariance = squares * (1.0 / n) - mean * mean.t();
  cv::Mat values, vectors;
  cv::eigen(covariance, values, vectors);
  if (values.at<double>(2) > kMaxThickness * cv::sum(values)[0]) return cv::Vec3f::all(kNan);
  cv::Vec3d normal(vectors.at<double>(2, 0), vectors.at<double>(2, 1), vectors.at<double>(2, 2));
  if (normal.dot(cv::Vec3d(p)) > 0) normal = -normal;
  return cv::Vec3f(normal);
}

// Directions in which a region's extent is measured.
const std::vector<cv::Vec3f>& Directions() {
  static const std::vector<cv::Vec3f> directions = [] {
    std::vector<cv::Vec3f> all;
    for (int i = 14; i < 27; ++i) {  // half of the 26 neighbours of a cell
      const cv::Vec3f d(static_cast<float>(i / 9 - 1), static_cast<float>(i / 3 % 3 - 1),
                        static_cast<float>(i % 3 - 1));
      all.push_back(d / cv::norm(d));
    }
    return all;
  }();
  return directions;
}

// Grows one planar region from `seed` and gives its largest extent.
float GrowRegion(DenseCloud& cloud, cv::Point seed, int region) {
  static const float kCosine = static_cast<float>(std::cos(15 * CV_PI / 180));
  std::vector<cv::Point> queue{seed};
  cloud.regions(seed) = region;
  cv::Vec3f normals(0, 0, 0), points(0, 0, 0);
  std::vector<std::array<float, 2>> reach(Directions().size(), {1e9F, -1e9F});
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const cv::Vec3f p = cloud.points(queue[next]);
    normals += cloud.normals(queue[next]);
    points += p;
    for (std::size_t k = 0; k < reach.size(); ++k) {
      const float along = Directions()[k].dot(p);
      reach[k] = {std::min(reach[k][0], along), std::max(reach[k][1], along)};
    }
    const cv::Vec3f normal = normals / cv::norm(normals), centre = points / static_cast<float>(next + 1);
    const auto tolerance = static_cast<float>(std::max(0.01, cloud.DepthSigma(static_cast<double>(p[2]))));
    for (const cv::Point step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point q = queue[next] + step;
      if (!cv::Rect(0, 0, cloud.points.cols, cloud.points.rows).contains(q) || cloud.regions(q) >= 0) continue;
      if (!(cloud.normals(q).dot(normal) > kCosine)) continue;
      if (next > 20 && std::abs(normal.dot(cloud.points(q) - centre)) > 2 * tolerance) continue;
      if (std::abs(normal.dot(cloud.points(q) - p)) > tolerance) continue;
      cloud.regions(q) = region;
      queue.push_back(q);
    }
  }
  float extent = 0;
  for (const auto& [low, high] : reach) extent = std::max(extent, high - low);
  return extent;
}

}  // namespace

StereoRig::StereoRig(const std::filesystem::path& calibration) {
  const cv::FileStorage file(calibration.string(), cv::FileStorage::READ);
  cv::Mat K1, D1, K2, D2, R, T, R1, R2, P1, P2, Q;
  file["K1"] >> K1;
  file["D1"] >> D1;
  file["K2"] >> K2;
  file["D2"] >> D2;
  file["R"] >> R;
  file["T"] >> T;
  const cv::Size size(static_cast<int>(file["image_width"]), static_cast<int>(file["image_height"]));
  cv::stereoRectify(K1, D1, K2, D2, size, R, T, R1, R2, P1, P2, Q, cv::CALIB_ZERO_DISPARITY, 0);
  cv::initUndistortRectifyMap(K1, D1, R1, P1, size, CV_32F, map_left_[0], map_left_[1]);
  cv::initUndistortRectifyMap(K2, D2, R2, P2, size, CV_32F, map_right_[0], map_right_[1]);
  R_raw_rectified = cv::Matx33d(R1).t();
  f = P1.at<double>(0, 0);
  cx = P1.at<double>(0, 2);
  cy = P1.at<double>(1, 2);
  f_baseline = -P2.at<double>(0, 3);
}

StereoRig::Rectified StereoRig::Rectify(const cv::Mat& left, const cv::Mat& right) const {
  Rectified pair;
  cv::remap(left, pair.left, map_left_[0], map_left_[1], cv::INTER_LINEAR);
  cv::remap(right, pair.right, map_right_[0], map_right_[1], cv::INTER_LINEAR);
  return pair;
}

bool DenseCloud::Project(const cv::Vec3d& p, cv::Point& pixel) const {
  if (p[2] < 0.05) return false;
  pixel = {cvRound((f * p[0] / p[2] + cx) / 2), cvRound((f * p[1] / p[2] + cy) / 2)};
  return cv::Rect(0, 0, points.cols, points.rows).contains(pixel);
}

DenseCloud MakeCloud(const StereoRig& rig, const StereoRig::Rectified& pair) {
  const cv::Mat3f full = Triangulate(rig, Disparity(pair));
  DenseCloud cloud;
  cloud.f = rig.f;
  cloud.cx = rig.cx;
  cloud.cy = rig.cy;
  cloud.f_baseline = rig.f_baseline;
  cloud.points = cv::Mat3f(full.rows / 2, full.cols / 2, cv::Vec3f::all(kNan));
  cloud.normals = cloud.points.clone();
  cloud.regions = cv::Mat1i(cloud.points.size(), -1);
  for (int y = 0; y < cloud.points.rows; ++y) {
    for (int x = 0; x < cloud.points.cols; ++x) {
      cloud.points(y, x) = full(2 * y, 2 * x);
      if (Known(cloud.points(y, x))) cloud.normals(y, x) = NormalAt(full, 2 * x, 2 * y, rig.f_baseline);
    }
  }
  for (int y = 0; y < cloud.points.rows; ++y) {
    for (int x = 0; x < cloud.points.cols; ++x) {
      if (cloud.regions(y, x) >= 0 || !Known(cloud.normals(y, x))) continue;
      cloud.extents.push_back(GrowRegion(cloud, {x, y}, static_cast<int>(cloud.extents.size())));
    }
  }
  return cloud;
}

}  // namespace wirepose::bench
