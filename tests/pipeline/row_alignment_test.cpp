// The estimate over frames, with corners projected exactly: what it says of good eyes, of turned ones and of late ones.
#include "pipeline/row_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace wirepose {
namespace {

// Where the right eye is against its calibrated place: p_eye = turn * p_calibrated + shift.
struct EyeError {
  Vector3d turn_rad = Vector3d::Zero(), shift_m = Vector3d::Zero();
  [[nodiscard]] Pose Motion() const {
    const double angle = turn_rad.norm();
    Pose T;
    if (angle > 0) T.R = Eigen::AngleAxisd(-angle, turn_rad / angle).toRotationMatrix();
    T.t = -shift_m;
    return T;
  }
};

class RowAlignmentTest : public ::testing::Test {
 protected:
  RowAlignmentTest() {
    camera_.f = 525;
    camera_.cx = 319.5;
    camera_.cy = 239.5;
    camera_.baseline = 0.12;
    camera_.width = 640;
    camera_.height = 480;
  }

  // `count` corners of a scene 0.6 to 3 m away as such an eye sees them; some of them mismatched.
  RowOffsets Corners(const EyeError& error, std::size_t count, double noise_px, double wrong_share) {
    std::uniform_real_distribution<double> u(10, 630), v(20, 460), nearness(1 / 3.0, 1 / 0.6), wrong(-6, 6),
        share(0, 1);
    std::normal_distribution<double> noise(0, noise_px);
    RowOffsets offsets;
    while (offsets.size() < count) {
      const double x = u(random_), y = v(random_);
      const double d = camera_.DisparityOfDepth(1 / nearness(random_));
      const Vector3d p = camera_.Triangulate(x, y, d) - Vector3d(camera_.baseline, 0, 0);
      const Vector3d q = error.Motion() * p;
      const double right_x = camera_.f * q.x() / q.z() + camera_.cx, right_y = camera_.f * q.y() / q.z() + camera_.cy;
      if (right_x < 0) continue;
      const bool is_wrong = share(random_) < wrong_share;
      offsets.push_back(
          {static_cast<float>(x), static_cast<float>(y), static_cast<float>(x - right_x),
           static_cast<float>(is_wrong ? wrong(random_) : right_y - y + (noise_px > 0 ? noise(random_) : 0))});
    }
    return offsets;
  }

  // Root mean square of the offsets that the error makes.
  double Truth(const EyeError& error) {
    double square = 0;
    for (int i = 0; i < 100; ++i) {
      for (const RowOffset& o : Corners(error, 20, 0, 0)) square += double{o.offset_px} * double{o.offset_px} / 2000;
    }
    return std::sqrt(square);
  }

  void Show(const RowOffsets& offsets) { monitor_.Update(camera_, {offsets.begin(), offsets.end()}); }
  void ShowUsual(const EyeError& error) { Show(Corners(error, 14, 0.15, 0.15)); }
  [[nodiscard]] const RowAlignment& alignment() const { return monitor_.alignment(); }

  std::mt19937 random_{11};
  RectifiedCamera camera_;
  AlignmentMonitor monitor_;
};

TEST_F(RowAlignmentTest, SaysNothingWithoutEnoughFramesOrCorners) {
  EXPECT_EQ(alignment().state, RowState::kUnknown);
  for (std::uint32_t i = 1; i < AlignmentMonitor::kMinFrames; ++i) Show(Corners({}, 14, 0.1, 0));
  EXPECT_EQ(alignment().state, RowState::kUnknown);
  Show(Corners({}, 14, 0.1, 0));
  EXPECT_EQ(alignment().state, RowState::kAligned);

  AlignmentMonitor blind;
  for (int i = 0; i < 200; ++i) {
    const RowOffsets few = Corners({}, AlignmentMonitor::kMinCorners - 1, 0.1, 0);
    blind.Update(camera_, {few.begin(), few.end()});
  }
  EXPECT_EQ(blind.alignment().state, RowState::kUnknown);
  EXPECT_EQ(blind.alignment().corners, AlignmentMonitor::kMinCorners - 1);
  blind.Update(camera_, {});
  EXPECT_EQ(blind.alignment().corners, 0u);
}

TEST_F(RowAlignmentTest, GoodEyesRaiseNoAlarm) {
  for (int i = 0; i < 3000; ++i) {
    ShowUsual({});
    ASSERT_LT(alignment().steady_px, 0.25F) << i;
    ASSERT_LT(alignment().varying_px, 0.25F) << i;
    ASSERT_NE(alignment().state, RowState::kSteadyOffset) << i;
    ASSERT_NE(alignment().state, RowState::kVaryingOffset) << i;
  }
}

TEST_F(RowAlignmentTest, LastFrameIsDescribedByMedianAndSpread) {
  RowOffsets offsets;
  for (const float v : {0.1F, 0.3F, 0.2F, 5.0F, 0.4F}) offsets.push_back({100, 100, 20, v});
  Show(offsets);
  EXPECT_EQ(alignment().corners, 5u);
  EXPECT_FLOAT_EQ(alignment().median_px, 0.3F);
  EXPECT_NEAR(alignment().spread_px, 1.48F * 0.1F, 1e-6F);
}

// Turned about each axis by as much as makes 1 px: found, and said to be steady, with the size that it has.
TEST_F(RowAlignmentTest, TurnedEyeIsASteadyOffset) {
  for (const Vector3d& turn_deg : {Vector3d(0.11, 0, 0), Vector3d(0, 0.8, 0), Vector3d(0, 0, 0.35)}) {
    SCOPED_TRACE(::testing::Message() << turn_deg.x() << ' ' << turn_deg.y() << ' ' << turn_deg.z() << " degrees");
    const EyeError error{turn_deg * kDegree, Vector3d::Zero()};
    monitor_ = {};
    for (int i = 0; i < 200; ++i) ShowUsual(error);
    EXPECT_EQ(alignment().state, RowState::kSteadyOffset);
    EXPECT_NEAR(alignment().steady_px, Truth(error), 0.25 * Truth(error));
    EXPECT_LT(alignment().varying_px, 0.5F * alignment().steady_px);
  }
}

// A robot that drives and nods, its right eye exposed late: the error swings with the motion.
TEST_F(RowAlignmentTest, LateEyeIsAVaryingOffsetWhileTheRigMoves) {
  const auto late = [](int frame, double dt_s) {
    const double swing = std::sin(0.4 * frame);
    return EyeError{Vector3d(0.4, 0.3, 0.2) * swing * dt_s, Vector3d(0.2, 0.1, 0.6) * swing * dt_s};
  };
  for (int i = 0; i < 200; ++i) ShowUsual(late(i, 0));
  EXPECT_EQ(alignment().state, RowState::kAligned);
  for (int i = 0; i < 200; ++i) ShowUsual(late(i, 0.010));
  EXPECT_EQ(alignment().state, RowState::kVaryingOffset) << alignment().varying_px;
  EXPECT_LT(alignment().steady_px, 0.5F * alignment().varying_px);
  for (int i = 0; i < 40; ++i) ShowUsual({});
  EXPECT_EQ(alignment().state, RowState::kAligned) << "the robot stands still";
}

TEST_F(RowAlignmentTest, MotionAlongTheRowsShowsNothing) {
  for (int i = 0; i < 200; ++i) ShowUsual({Vector3d::Zero(), {0.02 * std::sin(0.4 * i), 0, 0}});
  EXPECT_EQ(alignment().state, RowState::kAligned);
}

TEST_F(RowAlignmentTest, AFewWildFramesAreNoAlarm) {
  for (int i = 0; i < 300; ++i) {
    ShowUsual(i % 10 == 7 ? EyeError{{0.01, 0, 0}, Vector3d::Zero()} : EyeError{});
    ASSERT_NE(alignment().state, RowState::kVaryingOffset) << i;
    ASSERT_NE(alignment().state, RowState::kSteadyOffset) << i;
  }
}

// What was knocked changes first, and is steady once it has stayed.
TEST_F(RowAlignmentTest, AKnockBecomesSteady) {
  const EyeError error{{0.3 * kDegree, 0, 0}, Vector3d::Zero()};
  for (int i = 0; i < 300; ++i) ShowUsual({});
  for (int i = 0; i < 20; ++i) ShowUsual(error);
  EXPECT_EQ(alignment().state, RowState::kVaryingOffset);
  for (int i = 0; i < 280; ++i) ShowUsual(error);
  EXPECT_EQ(alignment().state, RowState::kSteadyOffset);
}

TEST_F(RowAlignmentTest, WhatIsLongAgoIsForgotten) {
  for (int i = 0; i < 100; ++i) ShowUsual({{0.01, 0, 0}, Vector3d::Zero()});
  EXPECT_EQ(alignment().state, RowState::kSteadyOffset);
  for (int i = 0; i < 149; ++i) Show({});
  EXPECT_EQ(alignment().state, RowState::kSteadyOffset) << "a wall without corners passes by";
  Show({});
  EXPECT_EQ(alignment().state, RowState::kUnknown);
}

TEST_F(RowAlignmentTest, SameOffsetsSameNumbers) {
  AlignmentMonitor other;
  for (int i = 0; i < 50; ++i) {
    const RowOffsets offsets = Corners({}, 20, 0.2, 0.2);
    Show(offsets);
    other.Update(camera_, {offsets.begin(), offsets.end()});
    ASSERT_EQ(alignment().steady_px, other.alignment().steady_px);
    ASSERT_EQ(alignment().varying_px, other.alignment().varying_px);
  }
}

}  // namespace
}  // namespace wirepose
