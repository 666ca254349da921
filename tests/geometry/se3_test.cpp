// Rotations and poses against Eigen's angle-axis in double precision, and the derivative of the
// perturbation against finite differences.
#include "geometry/se3.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <numbers>

#include "sim/random.h"

namespace wirepose {
namespace {

constexpr int kCases = 5000;

Vector3d AnyVector(sim::Random& random, double length) {
  Vector3d v(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
  return length * v.normalized();
}

Pose AnyPose(sim::Random& random) {
  return {ExpSo3(AnyVector(random, random.Uniform(0, 3))), AnyVector(random, random.Uniform(0, 2))};
}

TEST(Exp, AgreesWithAngleAxis) {
  sim::Random random(1);
  for (int i = 0; i < kCases; ++i) {
    const double angle = std::pow(10.0, random.Uniform(-9, 1.5));  // 1e-9 .. 31 rad
    const Vector3d w = AnyVector(random, angle);
    const Matrix3d expected = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
    // Each squaring doubles the relative error.
    EXPECT_LT((ExpSo3(w) - expected).cwiseAbs().maxCoeff(), 1e-14 * (1 + 4 * angle)) << angle;
  }
}

TEST(Exp, StaysARotationForHugeVectors) {
  sim::Random random(2);
  for (int i = 0; i < 500; ++i) {
    const double angle = random.Uniform(100, 5000);
    const Matrix3d R = ExpSo3(AnyVector(random, angle));
    EXPECT_LT((R * R.transpose() - Matrix3d::Identity()).norm(), 1e-10);
    EXPECT_GT(R.determinant(), 0.99);
  }
}

TEST(Exp, BoundaryCases) {
  EXPECT_TRUE(ExpSo3(Vector3d::Zero()) == Matrix3d::Identity());
  const Matrix3d half_turn = ExpSo3(Vector3d(0, 0, std::numbers::pi));
  EXPECT_NEAR(half_turn(0, 0), -1, 1e-13);
  EXPECT_NEAR(half_turn(0, 1), 0, 1e-13);
  // Below and above the step where the vector is halved for the first time.
  for (const double angle : {0.25 - 1e-12, 0.25, 0.25 + 1e-12}) {
    EXPECT_NEAR(ExpSo3(Vector3d(angle, 0, 0))(2, 1), std::sin(angle), 1e-14);
  }
}

TEST(Exp, InverseIsTheNegativeVector) {
  sim::Random random(3);
  for (int i = 0; i < kCases; ++i) {
    const Vector3d w = AnyVector(random, random.Uniform(0, 6));
    EXPECT_LT((ExpSo3(w) * ExpSo3(-w) - Matrix3d::Identity()).norm(), 1e-13);
  }
}

TEST(SkewMatrix, IsTheCrossProduct) {
  sim::Random random(4);
  for (int i = 0; i < kCases; ++i) {
    const Vector3d a = AnyVector(random, random.Uniform(0, 9)), b = AnyVector(random, 1);
    EXPECT_LT((Skew(a) * b - a.cross(b)).norm(), 1e-15 * (1 + a.norm()));
  }
}

// The nearest rotation in the Frobenius norm is U V^T of the singular value decomposition.
TEST(Orthonormalized, IsTheNearestRotation) {
  sim::Random random(5);
  for (int i = 0; i < 1000; ++i) {
    Matrix3d noise;
    for (int k = 0; k < 9; ++k) noise(k) = random.Uniform(-1, 1);
    const Matrix3d M = AnyPose(random).R + 1e-4 * noise;
    const Eigen::JacobiSVD<Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
    EXPECT_LT((Orthonormalize(M) - nearest).norm(), 1e-13);
  }
}

TEST(Poses, ComposeAndInvertAsFunctions) {
  sim::Random random(6);
  for (int i = 0; i < kCases; ++i) {
    const Pose A = AnyPose(random), B = AnyPose(random);
    const Vector3d p = AnyVector(random, 3);
    EXPECT_LT(((A * B) * p - A * (B * p)).norm(), 1e-13);
    EXPECT_LT((A.Inverse() * (A * p) - p).norm(), 1e-13);
  }
}

TEST(Perturbation, ZeroTwistChangesNothing) {
  sim::Random random(7);
  for (int i = 0; i < 100; ++i) {
    const Pose T = AnyPose(random);
    const Pose same = PerturbLeft(T, Vector6d::Zero(), AnyVector(random, 1));
    EXPECT_LT((same.R - T.R).norm() + (same.t - T.t).norm(), 1e-13);
  }
}

TEST(Perturbation, TurnsAboutTheCentre) {
  sim::Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const Pose T = AnyPose(random);
    const Vector3d centre = AnyVector(random, 2), p = AnyVector(random, 1), w = AnyVector(random, random.Uniform(0, 3)),
                   v = AnyVector(random, 1);
    Vector6d twist;
    twist << w, v;
    const Matrix3d R = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
    EXPECT_LT((PerturbLeft(T, twist, centre) * p - (R * (T * p - centre) + centre + v)).norm(), 1e-12);
  }
}

// d(T p)/d(twist) at 0 is [-[T p - c]x, I]: what refinement and promotion use.
TEST(Perturbation, DerivativeAgreesWithFiniteDifferences) {
  sim::Random random(9);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 1000; ++i) {
    const Pose T = AnyPose(random);
    const Vector3d p = AnyVector(random, 1), centre = AnyVector(random, 1);
    Eigen::Matrix<double, 3, 6> J;
    J << -Skew(T * p - centre), Matrix3d::Identity();
    for (int k = 0; k < 6; ++k) {
      const Vector6d step = kStep * Vector6d::Unit(k);
      const Vector3d numeric = (PerturbLeft(T, step, centre) * p - PerturbLeft(T, -step, centre) * p) / (2 * kStep);
      EXPECT_LT((numeric - J.col(k)).norm(), 1e-8);
    }
  }
}

}  // namespace
}  // namespace wirepose
