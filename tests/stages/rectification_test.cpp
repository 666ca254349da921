// Rectification against OpenCV: cv::initUndistortRectifyMap, cv::projectPoints,
// cv::undistortPoints, cv::remap.
#include "stages/rectification.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;

CameraIntrinsics AnyEye(Random& random) {
  return {random.Uniform(450, 650),    random.Uniform(450, 650),    random.Uniform(300, 340),
          random.Uniform(225, 255),    random.Uniform(-0.15, 0.05), random.Uniform(-0.02, 0.03),
          random.Uniform(-1e-3, 1e-3), random.Uniform(-1e-3, 1e-3), random.Uniform(-0.01, 0.01)};
}

// Eyes that squint by up to 9 degrees in any direction.
StereoCalibration AnyRig(Random& random) {
  StereoCalibration c;
  c.width = 640;
  c.height = 480;
  c.left = AnyEye(random);
  c.right = AnyEye(random);
  c.T_right_left.R = ExpSo3(random.Uniform(0, 9) * M_PI / 180 * testing::AnyDirection(random));
  c.T_right_left.t = random.Uniform(0.04, 0.2) * Vector3d(-1, random.Uniform(-0.1, 0.1), random.Uniform(-0.1, 0.1));
  return c;
}

cv::Mat ToCv(const Matrix3d& m) {
  cv::Mat_<double> out(3, 3);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out(r, c) = m(r, c);
  }
  return out;
}

cv::Mat CameraMatrix(const CameraIntrinsics& c) {
  return (cv::Mat_<double>(3, 3) << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
}
cv::Mat Distortion(const CameraIntrinsics& c) { return (cv::Mat_<double>(1, 5) << c.k1, c.k2, c.p1, c.p2, c.k3); }
cv::Mat RectifiedMatrix(const RectifiedCamera& c) {
  return (cv::Mat_<double>(3, 3) << c.f, 0, c.cx, 0, c.f, c.cy, 0, 0, 1);
}

// One eye with what OpenCV needs to know of it.
struct Eye {
  const CameraIntrinsics& raw;
  const RectificationMap& map;
  Matrix3d R;  // R_rectified_raw
};

std::array<Eye, 2> Eyes(const StereoCalibration& c, const Rectification& r) {
  return {
      {{c.left, r.left, r.T_rectified_raw.R}, {c.right, r.right, r.T_rectified_raw.R * c.T_right_left.R.transpose()}}};
}

// Where OpenCV finds each rectified pixel in the raw image.
void OpenCvMap(const Eye& eye, const RectifiedCamera& camera, cv::Mat& x, cv::Mat& y) {
  cv::initUndistortRectifyMap(CameraMatrix(eye.raw), Distortion(eye.raw), ToCv(eye.R), RectifiedMatrix(camera),
                              {camera.width, camera.height}, CV_32FC1, x, y);
}

// The map as its header defines it: nodes, linear between them.
Eigen::Vector2d MapAt(const RectificationMap& map, double u, double v) {
  constexpr int kStep = RectificationMap::kNodeStep;
  const int i = std::min(static_cast<int>(u) / kStep, RectificationMap::kNodesX - 2);
  const int j = std::min(static_cast<int>(v) / kStep, RectificationMap::kNodesY - 2);
  const double a = u / kStep - i, b = v / kStep - j;
  const auto node = [&](int p, int q) {
    const auto& n = map.nodes[static_cast<std::size_t>(q * RectificationMap::kNodesX + p)];
    return Eigen::Vector2d(n.x / 65536.0, n.y / 65536.0);
  };
  return (1 - b) * ((1 - a) * node(i, j) + a * node(i + 1, j)) +
         b * ((1 - a) * node(i, j + 1) + a * node(i + 1, j + 1));
}

TEST(Rectification, MapAgreesWithOpenCv) {
  Random random(1);
  const auto rectification = std::make_unique<Rectification>();
  for (int k = 0; k < Cases(30); ++k) {
    const StereoCalibration rig = AnyRig(random);
    ASSERT_TRUE(ComputeRectification(rig, *rectification));
    for (const Eye& eye : Eyes(rig, *rectification)) {
      cv::Mat x, y;
      OpenCvMap(eye, rectification->camera, x, y);
      double at_nodes = 0, between = 0;
      for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
          const Eigen::Vector2d expected(x.at<float>(v, u), y.at<float>(v, u));
          if (expected.x() < 0 || expected.y() < 0 || expected.x() > 639 || expected.y() > 479) continue;
          const double error = (MapAt(eye.map, u, v) - expected).norm();
          (u % 8 == 0 && v % 8 == 0 ? at_nodes : between) =
              std::max(u % 8 == 0 && v % 8 == 0 ? at_nodes : between, error);
        }
      }
      EXPECT_LT(at_nodes, 1e-4);
      EXPECT_LT(between, 0.03);  // strong lenses; usual ones bend less
    }
  }
}

// A 3D point, seen through OpenCV's model of both raw cameras, lies on one row and is shifted by f
// B / z.
TEST(Rectification, RowsAlignAndDisparityGivesDepth) {
  Random random(2);
  const auto rectification = std::make_unique<Rectification>();
  int seen_by_both = 0;
  for (int k = 0; k < Cases(100); ++k) {
    const StereoCalibration rig = AnyRig(random);
    ASSERT_TRUE(ComputeRectification(rig, *rectification));
    const RectifiedCamera& camera = rectification->camera;
    const auto eyes = Eyes(rig, *rectification);
    EXPECT_DOUBLE_EQ(camera.baseline, rig.T_right_left.t.norm());
    for (int i = 0; i < 100; ++i) {
      const double z = random.Uniform(0.4, 5);
      const Vector3d p(0.4 * z * random.Uniform(-1, 1), 0.3 * z * random.Uniform(-1, 1), z);
      cv::Point2d rectified[2];
      bool inside = true;
      for (std::size_t e = 0; e < 2; ++e) {
        const Vector3d q = e == 0 ? p : rig.T_right_left * p;
        std::vector<cv::Point2d> raw, ideal;
        cv::projectPoints(std::vector<cv::Point3d>{{q.x(), q.y(), q.z()}}, cv::Vec3d(), cv::Vec3d(),
                          CameraMatrix(eyes[e].raw), Distortion(eyes[e].raw), raw);
        cv::undistortPoints(raw, ideal, CameraMatrix(eyes[e].raw), Distortion(eyes[e].raw), ToCv(eyes[e].R),
                            RectifiedMatrix(camera),
                            cv::TermCriteria(cv::TermCriteria::MAX_ITER | cv::TermCriteria::EPS, 100, 1e-10));
        rectified[e] = ideal[0];
        inside = inside && raw[0].x >= 0 && raw[0].y >= 0 && raw[0].x <= 639 && raw[0].y <= 479;
        if (inside && ideal[0].x >= 0 && ideal[0].x < 639 && ideal[0].y >= 0 && ideal[0].y < 479) {
          // The raw pixel that our map gives for the rectified point is where OpenCV saw it.
          EXPECT_LT((MapAt(eyes[e].map, ideal[0].x, ideal[0].y) - Eigen::Vector2d(raw[0].x, raw[0].y)).norm(), 0.02);
        }
      }
      if (!inside) continue;
      ++seen_by_both;
      const Vector3d expected = camera.Project(rectification->T_rectified_raw * p);
      EXPECT_NEAR(rectified[0].y, rectified[1].y, 1e-3);
      EXPECT_NEAR(rectified[0].x, expected.x(), 1e-3);
      EXPECT_NEAR(rectified[0].y, expected.y(), 1e-3);
      EXPECT_NEAR(rectified[0].x - rectified[1].x, expected.z(), 1e-3);
    }
  }
  EXPECT_GT(seen_by_both, Cases(100) * 30);
}

TEST(Rectification, DistortionIsBrownConrady) {
  Random random(3);
  for (int k = 0; k < 1000; ++k) {
    const CameraIntrinsics eye = AnyEye(random);
    const double x = random.Uniform(-0.7, 0.7), y = random.Uniform(-0.6, 0.6);
    std::vector<cv::Point2d> q;
    cv::projectPoints(std::vector<cv::Point3d>{{x, y, 1}}, cv::Vec3d(), cv::Vec3d(), CameraMatrix(eye), Distortion(eye),
                      q);
    EXPECT_LT((DistortAndProject(eye, x, y) - Eigen::Vector2d(q[0].x, q[0].y)).norm(), 1e-9);
  }
}

// Every valid pixel was seen by the raw image, and of the runs of seen pixels in a row the longest
// one is valid: where barrel distortion makes the seen region hollow, a row at its rim has two. Two
// hundredths of a pixel may go either way.
TEST(Rectification, ValidIntervalsAreWhatTheRawImageCovers) {
  Random random(4);
  const auto rectification = std::make_unique<Rectification>();
  for (int k = 0; k < Cases(20); ++k) {
    const StereoCalibration rig = AnyRig(random);
    ASSERT_TRUE(ComputeRectification(rig, *rectification));
    for (const Eye& eye : Eyes(rig, *rectification)) {
      cv::Mat x, y;
      OpenCvMap(eye, rectification->camera, x, y);
      int unseen = 0, longer = 0, valid = 0;
      for (int v = 0; v < rig.height; ++v) {
        const auto [begin, end] = eye.map.valid[static_cast<std::size_t>(v)];
        ASSERT_LE(0, begin);
        ASSERT_LE(begin, end);
        ASSERT_LE(end, rig.width);
        valid += end - begin;
        int run = 0;
        for (int u = 0; u < rig.width; ++u) {
          const float px = x.at<float>(v, u), py = y.at<float>(v, u);
          const float margin = std::min({px, py, 639 - px, 479 - py});
          if (u >= begin && u < end && margin < -0.02F) ++unseen;
          run = margin > 0.02F ? run + 1 : 0;
          if (run > end - begin) ++longer;
        }
      }
      EXPECT_EQ(unseen, 0);
      EXPECT_EQ(longer, 0);
      EXPECT_GT(valid, 640 * 480 / 2);
    }
  }
}

TEST(Rectification, ImageAgreesWithRemap) {
  Random random(5);
  const auto rectification = std::make_unique<Rectification>();
  for (int k = 0; k < Cases(10); ++k) {
    const StereoCalibration rig = AnyRig(random);
    ASSERT_TRUE(ComputeRectification(rig, *rectification));
    const auto raw = testing::Paint(640, 480, [&](int x, int y) { return 128 + 120 * testing::Texture(x, y, 25, 7); });
    for (const Eye& eye : Eyes(rig, *rectification)) {
      testing::GrayImage ours{640, 480, std::vector<std::uint8_t>(640 * 480, 99)};
      RectifyImage(raw.view(), eye.map, ours.mutable_view());
      cv::Mat x, y, expected;
      OpenCvMap(eye, rectification->camera, x, y);
      cv::remap(cv::Mat(480, 640, CV_8U, const_cast<std::uint8_t*>(raw.pixels.data())), expected, x, y,
                cv::INTER_LINEAR);
      int worst = 0;
      for (int v = 0; v < 480; ++v) {
        const auto [begin, end] = eye.map.valid[static_cast<std::size_t>(v)];
        const std::uint8_t* row = ours.pixels.data() + v * 640;
        for (int u = begin; u < end; ++u) worst = std::max(worst, std::abs(row[u] - expected.at<std::uint8_t>(v, u)));
        // What the raw image does not show repeats the nearest pixel that it does, or is black.
        for (int u = 0; u < 640; ++u) {
          const int expected_level = begin == end ? 0 : row[std::clamp(u, int{begin}, end - 1)];
          ASSERT_EQ(row[u], expected_level);
        }
      }
      EXPECT_LE(worst, 1);
    }
  }
}

TEST(Rectification, ParallelIdenticalEyesStayAsTheyAre) {
  StereoCalibration rig;
  rig.width = 640;
  rig.height = 480;
  rig.left = rig.right = {500, 500, 319.5, 239.5};
  rig.T_right_left.t = {-0.1, 0, 0};
  const auto r = std::make_unique<Rectification>();
  ASSERT_TRUE(ComputeRectification(rig, *r));
  EXPECT_NEAR(r->camera.f, 500, 1e-9);
  EXPECT_NEAR(r->camera.cx, 319.5, 1e-9);
  EXPECT_NEAR(r->camera.cy, 239.5, 1e-9);
  EXPECT_LT((r->T_rectified_raw.R - Matrix3d::Identity()).norm(), 1e-12);
  const auto raw = testing::Paint(640, 480, [](int x, int y) { return (x * 7 + y * 13) % 256; });
  testing::GrayImage out{640, 480, std::vector<std::uint8_t>(640 * 480)};
  RectifyImage(raw.view(), r->left, out.mutable_view());
  EXPECT_EQ(out.pixels, raw.pixels);
}

TEST(Rectification, RefusesBadCalibrations) {
  Random random(6);
  const StereoCalibration good = AnyRig(random);
  const auto r = std::make_unique<Rectification>();
  ASSERT_TRUE(ComputeRectification(good, *r));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  const auto refused = [&](const char* what, const std::function<void(StereoCalibration&)>& spoil) {
    StereoCalibration bad = good;
    spoil(bad);
    EXPECT_FALSE(ComputeRectification(bad, *r)) << what;
  };
  for (const double f : {0.0, -500.0, kNan, kInf, 1e9}) {
    refused("focal length", [f](StereoCalibration& c) { c.left.fx = f; });
    refused("focal length", [f](StereoCalibration& c) { c.right.fy = f; });
  }
  for (const double x : {kNan, kInf}) {
    refused("principal point", [x](StereoCalibration& c) { c.left.cx = x; });
    refused("distortion", [x](StereoCalibration& c) { c.right.k2 = x; });
    refused("translation", [x](StereoCalibration& c) { c.T_right_left.t.x() = x; });
    refused("rotation", [x](StereoCalibration& c) { c.T_right_left.R(1, 2) = x; });
  }
  refused("no baseline", [](StereoCalibration& c) { c.T_right_left.t.setZero(); });
  refused("eyes exchanged", [](StereoCalibration& c) { c.T_right_left.t.x() *= -1; });
  refused("one eye above the other", [](StereoCalibration& c) { c.T_right_left.t = {0, -0.1, 0}; });
  refused("one eye behind the other", [](StereoCalibration& c) { c.T_right_left.t = {0, 0, -0.1}; });
  refused("mirrored", [](StereoCalibration& c) { c.T_right_left.R.col(0) *= -1; });
  refused("scaled", [](StereoCalibration& c) { c.T_right_left.R *= 1.01; });
  refused("70 degrees apart", [](StereoCalibration& c) { c.T_right_left.R = ExpSo3({0, 70 * M_PI / 180, 0}); });
}

}  // namespace
}  // namespace wirepose
