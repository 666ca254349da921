// Rigid motions and their tangent space.
#ifndef WIREPOSE_GEOMETRY_SE3_H_
#define WIREPOSE_GEOMETRY_SE3_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace wirepose {

using Vector2 = Eigen::Vector2f;
using Vector3 = Eigen::Vector3f;
using Matrix3 = Eigen::Matrix3f;
using Vector3d = Eigen::Vector3d;
using Matrix3d = Eigen::Matrix3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

inline constexpr double kDegree = std::numbers::pi / 180;  // rad

// A rigid motion T_target_source: p_target = R * p_source + t. Translation in metres.
struct Pose {
  Matrix3d R = Matrix3d::Identity();
  Vector3d t = Vector3d::Zero();

  [[nodiscard]] Vector3d operator*(const Vector3d& p_source) const { return R * p_source + t; }
  // T_a_c = T_a_b * T_b_c.
  [[nodiscard]] Pose operator*(const Pose& other) const { return {R * other.R, R * other.t + t}; }
  [[nodiscard]] Pose Inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
};

// [w]x, so that Skew(w) * v = w x v.
inline Matrix3d Skew(const Vector3d& w) {
  Matrix3d m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}

// Rotation by |w| radians about w (Rodrigues), for |w| up to some thousand rad. A Taylor series, exact to machine
// precision: |w| is halved until it is below 0.25 rad and the rotation squared back; + - * / only, so every target
// gives the same bytes.
inline Matrix3d ExpSo3(const Vector3d& w) {
  int halvings = 0;
  Vector3d v = w;
  while (v.squaredNorm() > 0.0625 && halvings < 16) {
    v *= 0.5;
    ++halvings;
  }
  const double q = v.squaredNorm();
  const double a = 1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72)));     // sin|v| / |v|
  const double b = 0.5 - q / 24 * (1 - q / 30 * (1 - q / 56 * (1 - q / 90)));  // (1 - cos|v|) / |v|^2
  const Matrix3d W = Skew(v);
  Matrix3d R = Matrix3d::Identity() + a * W + b * W * W;
  for (; halvings > 0; --halvings) R = (R * R).eval();
  return R;
}

// The nearest rotation by one Newton step of the polar decomposition; for matrices that are rotations up to rounding.
inline Matrix3d Orthonormalize(const Matrix3d& R) {
  Matrix3d Q = R;
  for (int i = 0; i < 2; ++i) Q = 1.5 * Q - 0.5 * Q * Q.transpose() * Q;
  return Q;
}

// exp of the twist (w, v): rotation w [rad] and translation v [m], both in the target frame and applied on the left
// with the rotation centre at `centre_target`: p -> ExpSo3(w) * (p - c) + c + v. The core's only pose perturbation.
inline Pose PerturbLeft(const Pose& T, const Vector6d& twist, const Vector3d& centre_target) {
  const Matrix3d dR = ExpSo3(twist.head<3>());
  return {Orthonormalize(dR * T.R), dR * (T.t - centre_target) + centre_target + twist.tail<3>()};
}

}  // namespace wirepose

#endif  // WIREPOSE_GEOMETRY_SE3_H_
