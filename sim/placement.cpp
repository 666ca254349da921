#include "sim/placement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/target_mesh.h"

namespace wirepose::sim {
namespace {

using Eigen::Vector2d;

// Half width of the support over the height of the centre: below this a touch tips the object over.
constexpr double kMinStability = 0.2;

std::array<Vector2d, 2> Axes(const Footprint& f) {
  const Vector2d u(std::cos(f.yaw_rad), std::sin(f.yaw_rad));
  return {u, Vector2d(-u.y(), u.x())};
}

double ReachAlong(const Footprint& f, const Vector2d& direction) {
  const auto [u, v] = Axes(f);
  return f.half.x() * std::abs(u.dot(direction)) + f.half.y() * std::abs(v.dot(direction));
}

RestingPose PoseAtRest(const Mesh& mesh, const Matrix3d& R) {
  Vector3d low = R * mesh.vertices.front().cast<double>(), high = low;
  for (const Vector3& vertex : mesh.vertices) {
    const Vector3d p = R * vertex.cast<double>();
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vector3d middle = 0.5 * (low + high);
  RestingPose pose;
  pose.T_table_object = {R, Vector3d(-middle.x(), -middle.y(), -low.z())};
  pose.half = 0.5 * (high - low).head<2>();
  pose.height = high.z() - low.z();
  return pose;
}

bool IsCuboidLike(const Mesh& mesh) {
  int half_turns = 0;
  for (const Pose& symmetry : BoxSymmetries(mesh)) {
    const Matrix3d& R = symmetry.R;
    if (R.diagonal().cwiseAbs().isOnes() && R.trace() == -1) ++half_turns;
  }
  return half_turns == 3;
}

}  // namespace

bool Overlap(const Footprint& a, const Footprint& b, double gap_m) {
  const Vector2d between = b.centre - a.centre;
  for (const Footprint& f : {a, b}) {
    for (const Vector2d& axis : Axes(f)) {
      const double reach = ReachAlong(a, axis) + ReachAlong(b, axis) + gap_m;
      if (std::abs(between.dot(axis)) >= reach) return false;
    }
  }
  return true;
}

std::vector<RestingPose> RestingPoses(const Mesh& mesh) {
  const RestingPose upright = PoseAtRest(mesh, Matrix3d::Identity());
  if (!IsCuboidLike(mesh)) return {upright};
  // Each of the three axes may stand upright; upside down looks the same.
  Matrix3d y_up, x_up;
  y_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  x_up << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  std::vector<RestingPose> poses;
  for (const Matrix3d& R : {Matrix3d(Matrix3d::Identity()), y_up, x_up}) {
    const RestingPose pose = PoseAtRest(mesh, R);
    if (pose.half.minCoeff() >= kMinStability * pose.height / 2) poses.push_back(pose);
  }
  return poses.empty() ? std::vector<RestingPose>{upright} : poses;
}

}  // namespace wirepose::sim
