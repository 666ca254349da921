#include "pipeline/track_motion.h"

#include <algorithm>
#include <cmath>

#include "base/portable_math.h"

namespace wirepose {
namespace {

Matrix6d Diagonal(double rotation, double translation) {
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>().diagonal().setConstant(rotation);
  m.bottomRightCorner<3, 3>().diagonal().setConstant(translation);
  return m;
}

// Column by column: Eigen solves for a whole matrix by blocks, on the heap where it cannot prove them small.
Matrix6d Solve(const Eigen::LDLT<Matrix6d>& ldlt, const Matrix6d& right) {
  Matrix6d out;
  for (int i = 0; i < 6; ++i) out.col(i) = ldlt.solve(Vector6d(right.col(i)));
  return out;
}

void Symmetrize(Matrix6d& m) { m = (0.5 * (m + m.transpose())).eval(); }

}  // namespace

Vector3d LogSo3(const Matrix3d& R) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(R).normalized();
  const Vector3d v = q.w() < 0 ? Vector3d(-q.vec()) : Vector3d(q.vec());
  const double n = v.norm();
  if (n < 1e-9) return 2 * v;
  // tan of a quarter of the angle, halved twice more; then the series of the arc tangent, to 1e-13.
  double x = n / (1 + std::abs(q.w()));
  for (int i = 0; i < 2; ++i) x = x / (1 + std::sqrt(1 + x * x));
  const double s = x * x;
  double series = 0;
  for (int k = 17; k > 0; k -= 2) series = 1.0 / k - s * series;
  return 16 * x * series / n * v;
}

Vector6d TwistBetween(const Pose& from, const Pose& to) {
  Vector6d twist;
  twist.head<3>() = LogSo3(to.R * from.R.transpose());
  twist.tail<3>() = to.t - from.t;
  return twist;
}

MovingPose StartMotion(const MotionParams& params, const Pose& measured, const Matrix6d& covariance) {
  MovingPose motion;
  motion.T = measured;
  motion.covariance = covariance;
  motion.velocity_covariance =
      Diagonal(params.first_rate_rad_s * params.first_rate_rad_s, params.first_speed_m_s * params.first_speed_m_s);
  return motion;
}

void Advance(const MotionParams& params, double dt_s, MovingPose& motion) {
  const double believed_s = std::min(dt_s, params.max_extrapolation_s);
  motion.T = PerturbLeft(motion.T, believed_s * motion.velocity, motion.T.t);
  const Matrix6d& C = motion.velocity_covariance;
  motion.covariance += dt_s * (motion.cross + motion.cross.transpose()) + dt_s * dt_s * C;
  motion.cross += dt_s * C;
  // Acceleration that is constant between two frames.
  const double rotation = params.angular_acceleration_rad_s2 * dt_s, translation = params.acceleration_m_s2 * dt_s;
  const Matrix6d noise = Diagonal(rotation * rotation, translation * translation);
  motion.covariance +=
      0.25 * dt_s * dt_s * noise + Diagonal(params.jitter_rad * params.jitter_rad, params.jitter_m * params.jitter_m);
  motion.cross += 0.5 * dt_s * noise;
  motion.velocity_covariance += noise;
  if (dt_s <= params.max_extrapolation_s) return;
  // Too long ago: at rest again, wherever it may have gone meanwhile.
  const double gone_rad = params.first_rate_rad_s * dt_s, gone_m = params.first_speed_m_s * dt_s;
  const MovingPose rest =
      StartMotion(params, motion.T, motion.covariance + Diagonal(gone_rad * gone_rad, gone_m * gone_m));
  motion = rest;
}

Fit FitOf(const MovingPose& motion, const Pose& measured, const Matrix6d& covariance) {
  const Eigen::LDLT<Matrix6d> ldlt(motion.covariance + covariance);
  const Vector6d twist = TwistBetween(motion.T, measured);
  Fit fit;
  fit.distance2 = twist.dot(Vector6d(ldlt.solve(twist)));
  fit.cost = fit.distance2;
  for (int i = 0; i < 6; ++i) {
    fit.cost += static_cast<double>(Log(static_cast<float>(std::max(ldlt.vectorD()(i), 1e-20))));
  }
  return fit;
}

void Correct(const Pose& measured, const Matrix6d& covariance, MovingPose& motion) {
  const Matrix6d A = motion.covariance, B = motion.cross;
  const Eigen::LDLT<Matrix6d> ldlt(A + covariance);
  const Vector6d innovation = ldlt.solve(TwistBetween(motion.T, measured));
  const Matrix6d by_A = Solve(ldlt, A), by_B = Solve(ldlt, B);
  motion.T = PerturbLeft(motion.T, A * innovation, motion.T.t);
  motion.velocity += B.transpose() * innovation;
  motion.covariance -= A * by_A;
  motion.cross -= A * by_B;
  motion.velocity_covariance -= B.transpose() * by_B;
  Symmetrize(motion.covariance);
  Symmetrize(motion.velocity_covariance);
}

Matrix6d MovedCovariance(const Matrix6d& covariance, const Vector3d& shift) {
  Matrix6d J = Matrix6d::Identity();
  J.bottomLeftCorner<3, 3>() = -Skew(shift);
  return J * covariance * J.transpose();
}

}  // namespace wirepose
