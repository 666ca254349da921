// OpenCV's calibration, run on rendered chessboards, must give the configured rig back within three
// of its own standard errors.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "test_scenes.h"

namespace wirepose::sim {
namespace {

constexpr int kColumns = 9, kRows = 6;  // inner corners
constexpr float kSquare = 0.03F;        // m
constexpr int kViews = 14;

// The board's first inner corner, its x and y axes as OpenCV counts corners.
std::vector<cv::Point3f> BoardCorners() {
  std::vector<cv::Point3f> corners;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      corners.emplace_back(kSquare * static_cast<float>(column), kSquare * static_cast<float>(row), 0.0F);
    }
  }
  return corners;
}

// A chessboard with a white margin, before a grey wall, evenly lit.
Scene Board(const Pose& T_world_board) {
  const float width = kSquare * (kColumns + 1), height = kSquare * (kRows + 1);
  Scene scene;
  scene.meshes = {MakeBox({width, height, 0.002F}), MakeBox({width + 0.05F, height + 0.05F, 0.002F}),
                  MakeBox({6, 6, 0.1F})};
  Instance board, margin, wall;
  board.mesh = 0;
  board.T_world_object = T_world_board;
  board.material = {Texture::kChecker, Mapping::kBox, 0.85F, 0.06F, kSquare, 0, 1};
  margin.mesh = 1;
  margin.T_world_object = T_world_board * Pose{Matrix3d::Identity(), Vector3d(0, 0, 0.0015)};
  margin.material.albedo = 0.85F;
  wall.mesh = 2;
  wall.T_world_object.t = Vector3d(0, 0, 3);
  wall.material.albedo = 0.4F;
  scene.instances = {board, margin, wall};
  scene.ambient_up = scene.ambient_down = 1;
  return scene;
}

cv::Mat ToMat(const dataset::GrayImage& image) {
  return cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())).clone();
}

bool FindCorners(const dataset::GrayImage& image, std::vector<cv::Point2f>& corners) {
  const cv::Mat mat = ToMat(image);
  if (!cv::findChessboardCorners(mat, {kColumns, kRows}, corners)) return false;
  cv::cornerSubPix(mat, corners, {5, 5}, {-1, -1}, {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 60, 1e-4});
  return true;
}

struct Views {
  std::vector<std::vector<cv::Point3f>> board;
  std::array<std::vector<std::vector<cv::Point2f>>, 2> corners;  // left, right
};

Views RenderViews(const StereoRig& rig) {
  Random random(51);
  Views views;
  for (std::uint64_t i = 0; i < 4 * kViews && views.board.size() < kViews; ++i) {
    Pose T;
    T.R = (Eigen::AngleAxisd(random.Uniform(-38, 38) * kDegree, Vector3d::UnitX()) *
           Eigen::AngleAxisd(random.Uniform(-38, 38) * kDegree, Vector3d::UnitY()) *
           Eigen::AngleAxisd(random.Uniform(-25, 25) * kDegree, Vector3d::UnitZ()))
              .toRotationMatrix();
    T.t = Vector3d(random.Uniform(-0.02, 0.14), random.Uniform(-0.07, 0.07), random.Uniform(0.45, 0.62));
    const StereoShot shot = ShootStereo(Renderer(Board(T)), rig, {.samples_per_side = 4, .threads = 2, .seed = 60 + i});
    std::vector<cv::Point2f> left, right;
    if (!FindCorners(shot.left, left) || !FindCorners(shot.right, right)) continue;
    // Both eyes must count the corners from the same end.
    if ((left.front() - left.back()).dot(right.front() - right.back()) < 0) continue;
    views.board.push_back(BoardCorners());
    views.corners[0].push_back(left);
    views.corners[1].push_back(right);
  }
  return views;
}

// Fails where a parameter is more than three standard errors off.
void CheckEye(const Views& views, int eye, const CameraIntrinsics& truth, const cv::Size& size) {
  cv::Mat K = cv::Mat::eye(3, 3, CV_64F), D = cv::Mat::zeros(1, 5, CV_64F);
  std::vector<cv::Mat> rotations, translations;
  cv::Mat intrinsic_sigma, extrinsic_sigma, errors;
  const double rms = cv::calibrateCamera(views.board, views.corners[static_cast<std::size_t>(eye)], size, K, D,
                                         rotations, translations, intrinsic_sigma, extrinsic_sigma, errors);
  EXPECT_LT(rms, 0.1);
  const std::array<double, 9> found = {K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2),
                                       K.at<double>(1, 2), D.at<double>(0),    D.at<double>(1),
                                       D.at<double>(2),    D.at<double>(3),    D.at<double>(4)};
  const std::array<double, 9> expected = {truth.fx, truth.fy, truth.cx, truth.cy, truth.k1,
                                          truth.k2, truth.p1, truth.p2, truth.k3};
  const char* names[] = {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double sigma = intrinsic_sigma.at<double>(static_cast<int>(i));
    EXPECT_LT(std::abs(found[i] - expected[i]), 3 * sigma) << "eye " << eye << " " << names[i] << " " << found[i];
    // An estimate that knows nothing would pass anything.
    EXPECT_LT(sigma, i < 4 ? 2.0 : i == 8 ? 1.0 : 0.1) << names[i];
  }
}

cv::Mat MatrixOf(const CameraIntrinsics& c) {
  return (cv::Mat_<double>(3, 3) << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
}
cv::Mat DistortionOf(const CameraIntrinsics& c) { return (cv::Mat_<double>(1, 5) << c.k1, c.k2, c.p1, c.p2, c.k3); }

Pose ToPose(const cv::Mat& rotation, const cv::Mat& translation) {
  cv::Matx33d R;
  cv::Rodrigues(rotation, R);
  Pose T;
  for (int i = 0; i < 9; ++i) T.R(i / 3, i % 3) = R(i / 3, i % 3);
  for (int i = 0; i < 3; ++i) T.t[i] = translation.at<double>(i);
  return T;
}

Vector3d RotationVector(const Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

Pose BoardPose(const Views& views, int eye, std::size_t view, const CameraIntrinsics& c) {
  cv::Mat rotation, translation;
  cv::solvePnP(views.board[view], views.corners[static_cast<std::size_t>(eye)][view], MatrixOf(c), DistortionOf(c),
               rotation, translation);
  return ToPose(rotation, translation);
}

TEST(Chessboard, OpenCvFindsTheConfiguredRig) {
  StereoRig rig;
  rig.calibration = test::SmallCalibration(0.5);
  const StereoCalibration& c = rig.calibration;
  const Views views = RenderViews(rig);
  ASSERT_EQ(views.board.size(), kViews);
  const cv::Size size(c.width, c.height);
  CheckEye(views, 0, c.left, size);
  CheckEye(views, 1, c.right, size);

  // The pose between the eyes with the configured intrinsics, since stereoCalibrate gives no
  // standard errors that could carry those of the intrinsics on; its own ones are the spread over
  // the views, each of which gives that pose alone.
  cv::Mat K1 = MatrixOf(c.left), D1 = DistortionOf(c.left), K2 = MatrixOf(c.right), D2 = DistortionOf(c.right);
  cv::Mat R, T, E, F, rotation;
  cv::stereoCalibrate(views.board, views.corners[0], views.corners[1], K1, D1, K2, D2, size, R, T, E, F,
                      cv::CALIB_FIX_INTRINSIC);
  cv::Rodrigues(R, rotation);
  const Pose found = ToPose(rotation, T);
  const Pose& truth = c.T_right_left;
  Vector6d variance = Vector6d::Zero();
  for (std::size_t i = 0; i < kViews; ++i) {
    const Pose view = BoardPose(views, 1, i, c.right) * BoardPose(views, 0, i, c.left).Inverse();
    Vector6d off;
    off << RotationVector(view.R * found.R.transpose()), view.t - found.t;
    variance += off.cwiseAbs2() / (kViews * (kViews - 1));
  }
  Vector6d off;
  off << RotationVector(found.R * truth.R.transpose()), found.t - truth.t;
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT(std::abs(off[i]), 3 * std::sqrt(variance[i])) << (i < 3 ? "rotation " : "translation ") << i % 3;
    EXPECT_LT(std::abs(off[i]), i < 3 ? 5e-4 : 3e-4) << "rad or m: the estimate itself is good";
  }
}

}  // namespace
}  // namespace wirepose::sim
