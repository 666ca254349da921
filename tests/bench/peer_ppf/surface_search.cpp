#include "surface_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/surface_matching/ppf_helpers.hpp>

namespace wirepose::bench {
namespace {

constexpr int kAngles = 30;  // bins of PPF angles
constexpr std::size_t kVoted = 4000, kClusters = 1500, kVerified = 400, kAligned = 30;
constexpr double kClusterD = 0.1, kClusterTurn = 18 * CV_PI / 180;
constexpr double kSurfaceStepD = 0.03;

cv::Mat ToMat(const std::vector<OrientedPoint>& points) {
  cv::Mat mat(static_cast<int>(points.size()), 6, CV_32F);
  for (int i = 0; i < mat.rows; ++i) {
    const OrientedPoint& p = points[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) {
      mat.at<float>(i, k) = p.point[k];
      mat.at<float>(i, 3 + k) = p.normal[k];
    }
  }
  return mat;
}

cv::Matx44d ToMatrix(const FoundPose& pose) {
  cv::Matx44d T = cv::Matx44d::eye();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) T(i, j) = pose.R(i, j);
    T(i, 3) = pose.t[i];
  }
  return T;
}

FoundPose FromMatrix(const cv::Matx44d& T) {
  FoundPose pose;
  cv::Mat w, u, vt;
  cv::SVD::compute(cv::Mat(T.get_minor<3, 3>(0, 0)), w, u, vt);  // OpenCV's rotations are not quite orthogonal
  pose.R = cv::Matx33d(cv::Mat(u * vt));
  pose.t = {T(0, 3), T(1, 3), T(2, 3)};
  return pose;
}

std::vector<cv::Matx33d> RotationsOf(const evaluation::ObjectTruth& object) {
  std::vector<cv::Matx33d> rotations;
  for (const evaluation::RigidMm& s : object.symmetries) {
    cv::Matx33d R;
    for (int i = 0; i < 9; ++i) R.val[i] = s.R(i / 3, i % 3);
    rotations.push_back(R);
  }
  return rotations;
}

}  // namespace

SurfaceSearch::SurfaceSearch(const mesh::Mesh& mesh, const evaluation::ObjectTruth& object)
    : diameter_m_(object.diameter_mm / 1000),
      step_(object.symmetries.size() > 1 ? 0.07 : 0.06),
      symmetries_(RotationsOf(object)),
      detector_(step_, step_, kAngles) {
  const auto dense = Sample(mesh, 0.006 * diameter_m_);
  surface_ = Thin(dense, kSurfaceStepD * diameter_m_);
  detector_.setSearchParams(1e-9, 1e-9);  // its own clustering off: every vote comes back
  detector_.trainModel(ToMat(Thin(dense, step_ * diameter_m_)));
}

void SurfaceSearch::MatchTile(const std::vector<OrientedPoint>& tile, std::vector<FoundPose>& poses) {
  std::vector<cv::ppf_match_3d::Pose3DPtr> found;
  detector_.match(ToMat(tile), found, 1.0 / 5, std::max(0.008, step_ * 0.4));
  for (const auto& vote : found) {
    FoundPose pose = FromMatrix(vote->pose);
    pose.score = static_cast<double>(vote->numVotes);
    // OpenCV takes the lower end of the angle's bin for its middle: turn by the other half about the point's normal.
    const float* reference = detector_.points().ptr<float>(static_cast<int>(vote->modelIndex));
    const cv::Vec3d point(cv::Vec3f{reference[0], reference[1], reference[2]});
    const cv::Vec3d normal(cv::Vec3f{reference[3], reference[4], reference[5]});
    const cv::Vec3d fixed = pose.R * point + pose.t;
    cv::Matx33d turn;
    cv::Rodrigues(pose.R * normal * (2 * CV_PI / kAngles), turn);
    pose.R = turn * pose.R;
    pose.t = fixed - pose.R * point;
    if (pose.t[2] > 0.1) poses.push_back(pose);
  }
}

double SurfaceSearch::TurnBetween(const cv::Matx33d& a, const cv::Matx33d& b) const {
  double least = CV_PI;
  for (const cv::Matx33d& s : symmetries_) {
    const double cosine = (cv::trace(a.t() * b * s) - 1) / 2;
    least = std::min(least, std::acos(std::clamp(cosine, -1.0, 1.0)));
  }
  return least;
}

std::vector<FoundPose> SurfaceSearch::Cluster(std::vector<FoundPose> poses) const {
  KeepBest(poses, kVoted);
  std::vector<FoundPose> clusters;
  for (const FoundPose& p : poses) {
    const auto same = [&](const FoundPose& c) {
      return cv::norm(p.t - c.t) < kClusterD * diameter_m_ && TurnBetween(p.R, c.R) < kClusterTurn;
    };
    const auto found = std::find_if(clusters.begin(), clusters.end(), same);
    if (found != clusters.end()) {
      found->score += p.score;
    } else if (clusters.size() < kClusters) {
      clusters.push_back(p);
    }
  }
  KeepBest(clusters, kVerified);
  return clusters;
}

double SurfaceSearch::Verify(const DenseCloud& cloud, const FoundPose& pose, double tolerance_factor,
                             std::vector<OrientedPoint>* visible) const {
  struct Seen {
    cv::Vec3d point, normal;
    cv::Point pixel, cell;
    std::size_t index;
  };
  const int cell_px = std::max(1, cvCeil(1.3 * kSurfaceStepD * diameter_m_ * cloud.f / 2 / std::max(0.1, pose.t[2])));
  std::vector<Seen> seen;
  std::map<std::pair<int, int>, double> front;  // nearest surface in each cell: what hides the object's own back
  double agrees = 0, violates = 0, hidden = 0, outside = 0;
  for (std::size_t i = 0; i < surface_.size(); ++i) {
    Seen s{pose.R * cv::Vec3d(surface_[i].point) + pose.t, pose.R * cv::Vec3d(surface_[i].normal), {}, {}, i};
    if (s.normal.dot(s.point) > -0.12 * cv::norm(s.point)) continue;
    if (!cloud.Project(s.point, s.pixel)) {
      ++outside;
      continue;
    }
    s.cell = {s.pixel.x / cell_px, s.pixel.y / cell_px};
    const auto [at, added] = front.try_emplace({s.cell.x, s.cell.y}, s.point[2]);
    if (!added) at->second = std::min(at->second, s.point[2]);
    seen.push_back(s);
  }
  for (const Seen& s : seen) {
    if (s.point[2] > front[{s.cell.x, s.cell.y}] + 0.1 * diameter_m_) continue;
    if (visible != nullptr) visible->push_back(surface_[s.index]);
    const cv::Vec3d there(cloud.points(s.pixel));
    if (!(there[2] == there[2])) {
      hidden += 0.7;
      continue;
    }
    const double sigma = std::max(0.025 * diameter_m_, 2.2 * cloud.DepthSigma(s.point[2]));
    const double tolerance = tolerance_factor * std::min(std::max(sigma, 0.015), 0.1 * diameter_m_);
    const double behind = there[2] - s.point[2];
    const double slant = std::max(0.3, -s.normal.dot(s.point) / cv::norm(s.point));
    if (std::abs(behind) * slant >= tolerance) {
      (behind > 0 ? violates : hidden) += 1;
      continue;
    }
    const int region = cloud.regions(s.pixel);
    const bool large = region >= 0 && static_cast<double>(cloud.extents[static_cast<std::size_t>(region)]) >
                                          kLargePlaneD * diameter_m_;
    const double cosine = s.normal.dot(cv::Vec3d(cloud.normals(s.pixel)));  // NaN: no normal there
    if (large) {
      violates += 0.7;
    } else if (!(cosine == cosine)) {
      agrees += 0.5;
    } else {
      agrees += cosine > 0.75 ? 1 : cosine > 0.5 ? 0.3 : 0;
      violates += cosine > 0.5 ? 0 : 0.3;
    }
  }
  const double all = agrees + violates + 0.5 * hidden + 0.5 * outside;
  return agrees + violates + hidden + outside < 5 ? -1 : (agrees - violates) / all;
}

void SurfaceSearch::Align(const DenseCloud& cloud, const std::vector<OrientedPoint>& scene, FoundPose& pose) const {
  std::vector<OrientedPoint> visible;
  Verify(cloud, pose, 1, &visible);
  const auto around = Thin(Near(scene, cv::Vec3f(pose.t), 0.62 * diameter_m_), 0.015 * diameter_m_);
  if (visible.size() < 40 || around.size() < 60) return;
  const cv::Matx44d start = ToMatrix(pose);
  const cv::Mat source = cv::ppf_match_3d::transformPCPose(ToMat(visible), start);
  cv::ppf_match_3d::ICP icp(100, 0.005F, 2.5F, 4);
  cv::Matx44d correction = cv::Matx44d::eye();
  double residual = 0;
  try {
    icp.registerModelToScene(source, ToMat(around), residual, correction);
  } catch (const cv::Exception&) {
    return;  // it fails on degenerate correspondences
  }
  FoundPose aligned = FromMatrix(correction * start);
  if (!(aligned.t[2] > 0.1)) return;
  aligned.score = Verify(cloud, aligned, 1, nullptr);
  if (aligned.score > pose.score) pose = aligned;
}

std::vector<FoundPose> SurfaceSearch::DoFind(const DenseCloud& cloud, std::size_t most) {
  const auto scene = Candidates(cloud, diameter_m_);
  const auto thin = Thin(scene, step_ * diameter_m_);
  std::vector<FoundPose> poses;
  for (const auto& indices : Tiles(thin, diameter_m_)) {
    std::vector<OrientedPoint> tile;
    for (const int i : indices) tile.push_back(thin[static_cast<std::size_t>(i)]);
    MatchTile(tile, poses);
  }
  poses = Cluster(std::move(poses));
  for (FoundPose& p : poses) p.score = Verify(cloud, p, 2.2, nullptr);
  KeepBest(poses, kAligned);
  for (FoundPose& p : poses) {
    p.score = Verify(cloud, p, 1, nullptr);
    Align(cloud, scene, p);
  }
  return KeepApart(std::move(poses), 0.25 * diameter_m_, most);
}

}  // namespace wirepose::bench
