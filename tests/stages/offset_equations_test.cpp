// The equations against generalised least squares with the full covariance of the offsets.
#include "stages/offset_equations.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;

constexpr OffsetErrors kErrors{};

// Edges of one to twelve samples, each seen by the left camera, the right one or both.
OffsetRows RandomRows(Random& random, int edges) {
  OffsetRows rows;
  for (int e = 0; e < edges; ++e) {
    const int samples = 1 + static_cast<int>(random.Uniform(0, 12));
    for (int k = 0; k < samples; ++k) {
      for (const std::uint8_t image : {0, 1}) {
        if (random.Uniform(0, 1) < 0.2) continue;
        OffsetRow row;
        for (int i = 0; i < 6; ++i) row.J(i) = random.Uniform(-300, 300);
        row.residual = random.Uniform(-3, 3);
        row.weight = random.Uniform(0.1, 1);
        row.edge = static_cast<std::uint16_t>(3 * e);
        row.image = image;
        const double angle = random.Uniform(0, 6.28);
        row.normal = Vector2(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
        rows.push_back(row);
      }
    }
  }
  return rows;
}

// The slow twin: every pair of offsets has its covariance.
struct Dense {
  Eigen::MatrixXd J, information;
  Eigen::VectorXd residual;

  Dense(const OffsetRows& rows, double shift_variance) {
    const auto n = static_cast<Eigen::Index>(rows.size());
    J.resize(n, 6);
    residual.resize(n);
    Eigen::MatrixXd covariance(n, n);
    const double noise = std::pow(double{kErrors.noise_px}, 2), edge = std::pow(double{kErrors.edge_px}, 2);
    for (Eigen::Index i = 0; i < n; ++i) {
      const OffsetRow& p = rows[static_cast<std::size_t>(i)];
      J.row(i) = p.J;
      residual(i) = p.residual;
      for (Eigen::Index j = 0; j < n; ++j) {
        const OffsetRow& q = rows[static_cast<std::size_t>(j)];
        covariance(i, j) = (i == j ? noise / p.weight : 0) + (p.edge == q.edge ? edge : 0);
        if (p.image == 1 && q.image == 1) {
          covariance(i, j) += shift_variance * p.normal.cast<double>().dot(q.normal.cast<double>());
        }
      }
    }
    information = noise * covariance.inverse();
  }
};

TEST(OffsetEquations, AreGeneralisedLeastSquares) {
  Random random(1);
  for (int k = 0; k < Cases(300); ++k) {
    const OffsetRows rows = RandomRows(random, 1 + k % 8);
    OffsetEquations equations(kErrors);
    Matrix6d H = Matrix6d::Zero();
    Vector6d g;
    equations.Sum(rows, H, g);
    const Dense dense(rows, 2 * std::pow(double{kErrors.image_px}, 2));
    const Matrix6d expected = dense.J.transpose() * dense.information * dense.J;
    const Vector6d right = dense.J.transpose() * dense.information * dense.residual;
    const Matrix6d lower = H.triangularView<Eigen::Lower>();
    const Matrix6d expected_lower = expected.triangularView<Eigen::Lower>();
    ASSERT_LT((lower - expected_lower).norm(), 1e-9 * (1 + expected.norm())) << k;
    ASSERT_LT((g - right).norm(), 1e-9 * (1 + right.norm())) << k;
  }
}

// Were the residuals as the model says, their sum would have the covariance that Spread gives: no less.
TEST(OffsetEquations, SpreadCoversTheModel) {
  Random random(2);
  OffsetErrors errors;
  errors.scatter_gain = 0;
  for (int k = 0; k < Cases(100); ++k) {
    OffsetRows rows = RandomRows(random, 6);
    for (OffsetRow& row : rows) row.weight = 1;
    OffsetEquations equations(errors);
    Matrix6d H = Matrix6d::Zero();
    Vector6d g;
    equations.Sum(rows, H, g);
    const Matrix6d spread = equations.Spread(rows);
    const Matrix6d expected = std::pow(double{errors.noise_px}, 2) * Matrix6d(H.selfadjointView<Eigen::Lower>());
    // With unit weights the covariance of the right side is the normal matrix times the unit variance. Spread has a
    // common error of the left image beside.
    const Eigen::SelfAdjointEigenSolver<Matrix6d> difference(spread - expected);
    EXPECT_GT(difference.eigenvalues().minCoeff(), -0.05 * expected.trace()) << k;
    const Eigen::SelfAdjointEigenSolver<Matrix6d> whole(spread);
    EXPECT_GT(whole.eigenvalues().minCoeff(), 0) << k;
  }
}

// All rows but the right image's agree with one pose.
TEST(OffsetEquations, FindTheShiftOfTheRightImage) {
  Random random(3);
  for (const double shift : {0.1, 0.5, 2.0}) {
    OffsetRows rows = RandomRows(random, 12);
    const Vector6d twist = 1e-3 * Vector6d::Ones();
    for (OffsetRow& row : rows) {
      row.weight = 1;
      row.residual = row.J * twist + (row.image == 1 ? shift * static_cast<double>(row.normal.x()) : 0);
    }
    OffsetEquations equations(kErrors);
    Vector6d solved;
    for (int i = 0; i < 20; ++i) {
      Matrix6d H = Matrix6d::Zero();
      Vector6d g;
      equations.Sum(rows, H, g);
      solved = Matrix6d(H.selfadjointView<Eigen::Lower>()).ldlt().solve(g);
      equations.Solved(solved);
    }
    EXPECT_NEAR(equations.shift().x(), shift, 0.15 * shift) << shift;
    EXPECT_NEAR(equations.shift().y(), 0, 0.1 * shift) << shift;
    EXPECT_LT((solved - twist).norm(), 0.3 * twist.norm()) << shift;
  }
}

// An edge that was taken for one 3 px beside it is seen so in both images: the rest of the pose stays, where equal
// weights would be pulled.
TEST(OffsetEquations, AWrongEdgeMovesThePoseLittle) {
  Random random(4);
  double ours = 0, equal = 0;
  for (int k = 0; k < Cases(200); ++k) {
    OffsetRows rows = RandomRows(random, 8);
    for (OffsetRow& row : rows) {
      row.weight = 1;
      row.residual = row.edge == rows[0].edge ? 3 : 0;
    }
    OffsetEquations equations(kErrors);
    Matrix6d H = Matrix6d::Zero(), plain = Matrix6d::Zero();
    Vector6d g, plain_g = Vector6d::Zero();
    equations.Sum(rows, H, g);
    for (const OffsetRow& row : rows) {
      plain += row.J.transpose() * row.J;
      plain_g += row.residual * row.J.transpose();
    }
    ours += Matrix6d(H.selfadjointView<Eigen::Lower>()).ldlt().solve(g).norm();
    equal += plain.ldlt().solve(plain_g).norm();
  }
  EXPECT_LT(ours, 0.7 * equal);
}

TEST(OffsetEquations, NoRowsAndOneImageAreNoTrouble) {
  Random random(5);
  OffsetEquations equations(kErrors);
  Matrix6d H = Matrix6d::Zero();
  Vector6d g;
  equations.Sum({}, H, g);
  EXPECT_EQ(H.norm(), 0);
  EXPECT_EQ(g.norm(), 0);
  EXPECT_EQ(equations.Spread({}).norm(), 0);
  OffsetRows rows = RandomRows(random, 5);
  for (OffsetRow& row : rows) row.image = 0;
  equations.Sum(rows, H, g);
  equations.Solved(Vector6d::Ones());
  EXPECT_EQ(equations.shift().norm(), 0);
}

}  // namespace
}  // namespace wirepose
