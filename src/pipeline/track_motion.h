// A pose that moves: Kalman filter on SE(3) with constant velocity.
#ifndef WIREPOSE_PIPELINE_TRACK_MOTION_H_
#define WIREPOSE_PIPELINE_TRACK_MOTION_H_

#include "geometry/se3.h"

namespace wirepose {

struct MotionParams {
  // Standard deviation of the acceleration between two frames. Mostly the robot's own: a camera that turns moves what
  // it sees at 1 m by as many metres as it turns by radians.
  double acceleration_m_s2 = 1.5, angular_acceleration_rad_s2 = 1.5;
  double first_speed_m_s = 0.5, first_rate_rad_s = 0.3;  // what a new object may move by
  double jitter_m = 0.0005, jitter_rad = 0.002;          // a frame: what constant velocity does not explain
  double max_extrapolation_s = 0.3;                      // velocities are believed for that long
};

// Twists are those of PerturbLeft about the model origin, rotation first, in the camera's axes.
struct MovingPose {
  Pose T;
  Vector6d velocity = Vector6d::Zero();                                  // rad/s, m/s
  Matrix6d covariance = Matrix6d::Identity(), cross = Matrix6d::Zero();  // of the pose; of pose and velocity
  Matrix6d velocity_covariance = Matrix6d::Identity();
};

// Rotation vector of R, |w| <= pi; inverse of ExpSo3. + - * / and sqrt only.
[[nodiscard]] Vector3d LogSo3(const Matrix3d& R);

// The twist that PerturbLeft takes from one pose to the other.
[[nodiscard]] Vector6d TwistBetween(const Pose& from, const Pose& to);

// At rest at the measured pose, up to first_speed and first_rate.
[[nodiscard]] MovingPose StartMotion(const MotionParams& params, const Pose& measured, const Matrix6d& covariance);

// Predicts by dt_s >= 0.
void Advance(const MotionParams& params, double dt_s, MovingPose& motion);

// How well a measurement fits the prediction: squared Mahalanobis distance (chi-square, 6 degrees of freedom) and
// -2 log likelihood up to a constant.
struct Fit {
  double distance2 = 0, cost = 0;
};
[[nodiscard]] Fit FitOf(const MovingPose& motion, const Pose& measured, const Matrix6d& covariance);

void Correct(const Pose& measured, const Matrix6d& covariance, MovingPose& motion);

// `covariance` after the origin that twists turn about has moved by `shift` in the camera frame.
[[nodiscard]] Matrix6d MovedCovariance(const Matrix6d& covariance, const Vector3d& shift);

}  // namespace wirepose

#endif  // WIREPOSE_PIPELINE_TRACK_MOTION_H_
