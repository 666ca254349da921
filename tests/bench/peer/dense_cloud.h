// What a user of OpenCV or PCL would give a recognizer: an organised cloud from StereoSGBM.
#ifndef WIREPOSE_TESTS_BENCH_PEER_DENSE_CLOUD_H_
#define WIREPOSE_TESTS_BENCH_PEER_DENSE_CLOUD_H_

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

namespace wirepose::bench {

// A calibrated pair, rectified by OpenCV itself.
class StereoRig {
 public:
  // Throws cv::Exception when the file is none that OpenCV writes.
  explicit StereoRig(const std::filesystem::path& calibration);

  struct Rectified {
    cv::Mat left, right;
  };
  [[nodiscard]] Rectified Rectify(const cv::Mat& left, const cv::Mat& right) const;

  cv::Matx33d R_raw_rectified;   // left camera
  double f = 0, cx = 0, cy = 0;  // rectified, px
  double f_baseline = 0;         // px m

 private:
  cv::Mat map_left_[2], map_right_[2];
};

// Half the image's resolution: pixel (x, y) shows image pixel (2x, 2y). Rectified left frame, m.
struct DenseCloud {
  cv::Mat3f points;            // NaN where nothing is known
  cv::Mat3f normals;           // towards the camera; NaN where the surface is not plane enough
  cv::Mat1i regions;           // planar region of each point with a normal; -1: none
  std::vector<float> extents;  // largest extent of each region, m
  double f = 0, cx = 0, cy = 0, f_baseline = 0;

  // Standard deviation of depth by half a pixel of disparity.
  [[nodiscard]] double DepthSigma(double z) const { return 0.5 * z * z / f_baseline; }
  // The pixel that shows a point; false: none does.
  [[nodiscard]] bool Project(const cv::Vec3d& p, cv::Point& pixel) const;
};

DenseCloud MakeCloud(const StereoRig& rig, const StereoRig::Rectified& pair);

}  // namespace wirepose::bench

#endif  // WIREPOSE_TESTS_BENCH_PEER_DENSE_CLOUD_H_
