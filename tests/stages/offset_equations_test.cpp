// The equations against generalised least squares with the full covariance of the offsets.
#include "stages/offset_equations.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

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

double Squared(float x) { return std::pow(static_cast<double>(x), 2); }

double ShiftVariance() { return 2 * Squared(kErrors.image_px); }

// The slow twin: every pair of offsets has its covariance.
struct Dense {
  Eigen::MatrixXd J, normals,
      information;  // derivatives by the twist, by the shift; inverse covariance times noise_px^2
  Eigen::VectorXd residual;

  Dense(const OffsetRows& rows, double shift_variance) {
    const auto n = static_cast<Eigen::Index>(rows.size());
    J.resize(n, 6);
    normals.setZero(n, 2);
    residual.resize(n);
    Eigen::MatrixXd covariance(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const OffsetRow& p = rows[static_cast<std::size_t>(i)];
      J.row(i) = p.J;
      residual(i) = p.residual;
      if (p.image == 1) normals.row(i) = p.normal.cast<double>();
      for (Eigen::Index j = 0; j < n; ++j) {
        const OffsetRow& q = rows[static_cast<std::size_t>(j)];
        covariance(i, j) =
            (i == j ? Squared(kErrors.noise_px) / p.weight : 0) + (p.edge == q.edge ? Squared(kErrors.edge_px) : 0);
      }
    }
    covariance += shift_variance * normals * normals.transpose();
    information = Squared(kErrors.noise_px) * covariance.inverse();
  }

  [[nodiscard]] Matrix6d H() const { return J.transpose() * information * J; }
  [[nodiscard]] Vector6d g() const { return J.transpose() * information * residual; }
  // The most probable shift at a twist.
  [[nodiscard]] Eigen::Vector2d Shift(const Vector6d& twist, double shift_variance) const {
    return shift_variance / Squared(kErrors.noise_px) * normals.transpose() * information * (residual - J * twist);
  }
};

void ExpectSums(OffsetEquations& equations, const OffsetRows& rows, const Dense& dense) {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g;
  equations.Sum(rows, H, g);
  const Matrix6d whole = H.selfadjointView<Eigen::Lower>();
  ASSERT_LT((whole - dense.H()).norm(), 1e-9 * (1 + dense.H().norm()));
  ASSERT_LT((g - dense.g()).norm(), 1e-9 * (1 + dense.g().norm()));
}

TEST(OffsetEquations, AreGeneralisedLeastSquares) {
  Random random(1);
  for (int k = 0; k < Cases(300); ++k) {
    const OffsetRows rows = RandomRows(random, 1 + k % 8);
    OffsetEquations equations(kErrors);
    ExpectSums(equations, rows, Dense(rows, ShiftVariance()));
  }
}

// The variance of the shift grows with the shift that was found.
TEST(OffsetEquations, LargeShiftsAreBelieved) {
  Random random(6);
  double largest = 0;
  for (int k = 0; k < Cases(300); ++k) {
    const OffsetRows rows = RandomRows(random, 2 + k % 8);
    OffsetEquations equations(kErrors);
    const Dense first(rows, ShiftVariance());
    ExpectSums(equations, rows, first);
    const Vector6d twist = random.Uniform(0, 0.02) * Vector6d::Ones();
    equations.UpdateShift(twist);
    const Eigen::Vector2d shift = first.Shift(twist, ShiftVariance());
    ASSERT_LT((equations.shift() - shift).norm(), 1e-9 * (1 + shift.norm()));
    const double share = 1 / (1 + shift.squaredNorm() / (4 * ShiftVariance()));
    ExpectSums(equations, rows, Dense(rows, ShiftVariance() / (share * share)));
    largest = std::max(largest, shift.norm());
  }
  EXPECT_GT(largest, 3 * std::sqrt(ShiftVariance()));
}

// The covariance of the right side, were the residuals' errors those of the model: of a sample and of an edge by what
// the residuals show, of each image as it is.
TEST(OffsetEquations, SpreadIsTheCovarianceOfTheRightSide) {
  Random random(2);
  for (int k = 0; k < Cases(200); ++k) {
    OffsetErrors errors;
    if (k % 2 == 0) errors.scatter_gain = 0;
    const OffsetRows rows = RandomRows(random, 1 + k % 8);
    OffsetEquations equations(errors);
    Matrix6d H = Matrix6d::Zero();
    Vector6d g;
    equations.Sum(rows, H, g);
    double squares = 0, total = 0, scatter = 0;
    for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
      double weight = 0, mean = 0;
      for (; end < rows.size() && rows[end].edge == rows[begin].edge; ++end) {
        weight += rows[end].weight;
        mean += rows[end].weight * rows[end].residual;
        squares += rows[end].weight * rows[end].residual * rows[end].residual;
      }
      scatter += mean * mean / weight;
      total += weight;
    }
    const double gain = static_cast<double>(errors.scatter_gain) / std::max(total, 1e-9);
    const auto n = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd covariance(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        const OffsetRow &p = rows[static_cast<std::size_t>(i)], &q = rows[static_cast<std::size_t>(j)];
        covariance(i, j) =
            (i == j ? Squared(errors.noise_px) + gain * squares : 0) +
            (p.edge == q.edge ? Squared(errors.edge_px) + gain * scatter : 0) +
            (p.image == q.image ? Squared(errors.image_px) * p.normal.cast<double>().dot(q.normal.cast<double>()) : 0);
      }
    }
    const Dense dense(rows, ShiftVariance());
    const Eigen::MatrixXd A = dense.J.transpose() * dense.information;
    const Matrix6d expected = A * covariance * A.transpose();
    ASSERT_LT((equations.Spread(rows) - expected).norm(), 1e-9 * (1 + expected.norm())) << k;
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
      equations.UpdateShift(solved);
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
  equations.UpdateShift(Vector6d::Ones());
  EXPECT_EQ(equations.shift().norm(), 0);
}

}  // namespace
}  // namespace wirepose
