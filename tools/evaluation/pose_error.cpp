#include "tools/evaluation/pose_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace wirepose::evaluation {
namespace {

constexpr int kTurnSteps = 64;
constexpr double kNearestDepthMm = 1e-6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Pixel of a point; not finite when it is not in front of the camera.
Eigen::Vector2d Project(const Vector3d& p, const Matrix3d& K) {
  if (!(p.z() > kNearestDepthMm)) return {kInfinity, kInfinity};
  return {p.x() / p.z() * K(0, 0) + K(0, 2), p.y() / p.z() * K(1, 1) + K(1, 2)};
}

struct Distances {
  double surface_mm = 0;
  double projection_px = 0;  // infinite if any vertex is behind the camera in either pose
};

Distances LargestDistances(const std::vector<Vector3d>& vertices, const Matrix3d& K, const RigidMm& a,
                           const RigidMm& b) {
  double surface2 = 0;
  double projection2 = 0;
  for (const Vector3d& v : vertices) {
    const Vector3d pa = a * v;
    const Vector3d pb = b * v;
    surface2 = std::max(surface2, (pa - pb).squaredNorm());
    const double d2 = (Project(pa, K) - Project(pb, K)).squaredNorm();
    projection2 = std::isfinite(d2) ? std::max(projection2, d2) : kInfinity;
  }
  return {std::sqrt(surface2), std::sqrt(projection2)};
}

double AngleDeg(const Matrix3d& R) {
  const double cosine = std::clamp((R.trace() - 1) / 2, -1.0, 1.0);
  return std::acos(cosine) * 180 / std::numbers::pi;
}

}  // namespace

PoseError MeasurePose(const ObjectTruth& object, const Matrix3d& K, const RigidMm& estimate, const RigidMm& truth) {
  PoseError best;
  best.mssd_mm = kInfinity;
  best.mspd_px = kInfinity;
  for (const RigidMm& symmetry : object.symmetries) {
    const RigidMm candidate = truth * symmetry;
    const Distances d = LargestDistances(object.vertices_mm, K, estimate, candidate);
    best.mspd_px = std::min(best.mspd_px, d.projection_px);
    if (d.surface_mm < best.mssd_mm) {
      best.mssd_mm = d.surface_mm;
      best.nearest_truth = candidate;
    }
  }
  best.translation_mm = (estimate.t_mm - best.nearest_truth.t_mm).norm();
  best.rotation_deg = AngleDeg(best.nearest_truth.R.transpose() * estimate.R);
  return best;
}

std::vector<RigidMm> EnumerateSymmetries(const std::vector<RigidMm>& discrete,
                                         const std::vector<ContinuousSymmetry>& continuous) {
  std::vector<RigidMm> all{RigidMm{}};
  all.insert(all.end(), discrete.begin(), discrete.end());
  const std::vector<RigidMm> base = all;
  for (const ContinuousSymmetry& c : continuous) {
    for (int k = 1; k < kTurnSteps; ++k) {
      const double angle = 2 * std::numbers::pi * k / kTurnSteps;
      const Matrix3d R = Eigen::AngleAxisd(angle, c.axis.normalized()).toRotationMatrix();
      const RigidMm turn{R, c.offset_mm - R * c.offset_mm};
      for (const RigidMm& s : base) all.push_back(turn * s);
    }
  }
  return all;
}

double NormalizedErrorSquared(const RigidMm& estimate, const RigidMm& truth, const Matrix6d& covariance) {
  constexpr double kMetresPerMm = 1e-3;
  const Eigen::AngleAxisd rotation(Matrix3d(truth.R * estimate.R.transpose()));
  Vector6d twist;
  twist << rotation.angle() * rotation.axis(), (truth.t_mm - estimate.t_mm) * kMetresPerMm;
  const Eigen::LLT<Matrix6d> factor(covariance);
  if (factor.info() != Eigen::Success) return -1;
  return twist.dot(factor.solve(twist));
}

double ChiSquare6Cdf(double x) {
  if (x <= 0) return 0;
  const double h = x / 2;
  return 1 - std::exp(-h) * (1 + h + h * h / 2);
}

}  // namespace wirepose::evaluation
