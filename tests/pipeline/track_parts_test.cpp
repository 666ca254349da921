// The tracker's parts against slow, honest twins: rotation vectors, the motion filter, the assignment.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "pipeline/assignment.h"
#include "track_world.h"

namespace wirepose {
namespace {

using testing::TrackWorld;

TEST(TrackMotion, LogIsTheInverseOfExp) {
  TrackWorld world(1);
  for (int i = 0; i < 5000; ++i) {
    const double angle = i % 5 == 0 ? world.Uniform(0, 1e-6) : world.Uniform(0, 3.1415);
    const Vector3d w = angle * world.AnyVector(1).normalized();
    EXPECT_LT((LogSo3(ExpSo3(w)) - w).norm(), 1e-9) << angle;
  }
}

TEST(TrackMotion, TwistTakesOnePoseToTheOther) {
  TrackWorld world(2);
  for (int i = 0; i < 200; ++i) {
    const Pose p{ExpSo3(world.AnyVector(1)), world.AnyVector(1)}, q{ExpSo3(world.AnyVector(1)), world.AnyVector(1)};
    const Pose reached = PerturbLeft(p, TwistBetween(p, q), p.t);
    EXPECT_LT((reached.R - q.R).norm() + (reached.t - q.t).norm(), 1e-8);
  }
}

// The blocks of the filter against the textbook's 12 x 12 matrices.
TEST(TrackMotion, BlocksAreTheTextbookFilter) {
  using Matrix12 = Eigen::Matrix<double, 12, 12>;
  TrackWorld world(3);
  const MotionParams params;
  const Matrix6d R = world.Covariance({});
  MovingPose motion = StartMotion(params, {Matrix3d::Identity(), {0, 0, 1}}, R);
  Matrix12 P = Matrix12::Zero();
  P.topLeftCorner<6, 6>() = motion.covariance;
  P.bottomRightCorner<6, 6>() = motion.velocity_covariance;
  const double dt = 0.05;
  Vector6d a, jitter;
  a << Vector3d::Constant(params.angular_acceleration_rad_s2), Vector3d::Constant(params.acceleration_m_s2);
  jitter << Vector3d::Constant(params.jitter_rad), Vector3d::Constant(params.jitter_m);
  for (int i = 0; i < 20; ++i) {
    Matrix12 F = Matrix12::Identity();
    F.topRightCorner<6, 6>() = dt * Matrix6d::Identity();
    Eigen::Matrix<double, 12, 6> G;
    G << 0.5 * dt * dt * Matrix6d::Identity(), dt * Matrix6d::Identity();
    P = F * P * F.transpose() + G * Matrix6d(a.cwiseAbs2().asDiagonal()) * G.transpose();
    P.topLeftCorner<6, 6>() += Matrix6d(jitter.cwiseAbs2().asDiagonal());
    Advance(params, dt, motion);
    const Eigen::Matrix<double, 12, 6> K = P.leftCols<6>() * (P.topLeftCorner<6, 6>() + R).inverse();
    P = (P - K * P.topRows<6>()).eval();
    Correct(PerturbLeft(motion.T, 0.01 * Vector6d::Ones(), motion.T.t), R, motion);
    EXPECT_LT((P.topLeftCorner<6, 6>() - motion.covariance).norm(), 1e-9);
    EXPECT_LT((P.topRightCorner<6, 6>() - motion.cross).norm(), 1e-9);
    EXPECT_LT((P.bottomRightCorner<6, 6>() - motion.velocity_covariance).norm(), 1e-9);
  }
}

// The least sum: all assignments are tried.
TEST(Assignment, IsTheBestOfAll) {
  TrackWorld world(4);
  for (int i = 0; i < 2000; ++i) {
    MatchCosts costs;
    costs.detections = static_cast<std::size_t>(world.Uniform(0, 4.99));
    costs.tracks = static_cast<std::size_t>(world.Uniform(0, 4.99));
    for (std::size_t d = 0; d < costs.detections; ++d) {
      for (std::size_t t = 0; t < costs.tracks; ++t) {
        costs.cost[d][t] = world.Uniform(0, 1) < 0.4 ? MatchCosts::kNoMatch : world.Uniform(-90, 90);
      }
    }
    const auto total = [&](const auto& track_of) {
      double sum = 0;
      for (std::size_t d = 0; d < costs.detections; ++d)
        sum += track_of[d] < costs.tracks ? costs.cost[d][track_of[d]] : MatchCosts::kUnmatched;
      return sum;
    };
    // Columns beyond the tracks mean "none".
    std::vector<std::size_t> columns(costs.tracks + costs.detections);
    std::iota(columns.begin(), columns.end(), 0);
    double best = 1e12;
    do {
      best = std::min(best, total(columns));
    } while (std::next_permutation(columns.begin(), columns.end()));
    const auto found = AssignTracks(costs);
    ASSERT_EQ(found.size(), costs.detections);
    EXPECT_NEAR(total(found), best, 1e-6);
    for (std::size_t d = 0; d < found.size(); ++d) {
      if (found[d] == kNoTrack) continue;
      EXPECT_EQ(std::count(found.begin(), found.end(), found[d]), 1);
    }
  }
}

// The canonical pose does not depend on which of the equal poses it is made from.
TEST(Symmetry, OneCanonicalPoseAClass) {
  TrackWorld world(5);
  const PreparedModel& model = world.model(1);
  for (int i = 0; i < 2000; ++i) {
    const Matrix3d R = ExpSo3(world.AnyVector(2));
    const Matrix3d canonical = R * model.symmetries[NearestSymmetry(model, R, CanonicalOrientation())].R;
    for (const Pose& S : model.symmetries) {
      const Matrix3d other = R * S.R;
      const Matrix3d same = other * model.symmetries[NearestSymmetry(model, other, CanonicalOrientation())].R;
      EXPECT_LT((same - canonical).norm(), 1e-9);
    }
  }
}

TEST(Symmetry, BoxTurnsAreTheRotationsOfTheCube) {
  for (std::size_t k = 0; k < kBoxTurns; ++k) {
    EXPECT_EQ(BoxTurn(k) * BoxTurn(k).transpose(), Matrix3d::Identity());
    EXPECT_EQ(BoxTurn(k).determinant(), 1);
    for (std::size_t j = 0; j < k; ++j) EXPECT_NE(BoxTurn(j), BoxTurn(k));
  }
  EXPECT_EQ(BoxTurn(0), Matrix3d::Identity());
}

}  // namespace
}  // namespace wirepose
