#include "prerejective_search.h"

#include <pcl/common/transforms.h>
#include <pcl/features/fpfh.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/sample_consensus_prerejective.h>

#include <algorithm>
#include <cstdlib>

namespace wirepose::bench {
namespace {

// In diameters: voxel size of the search and of what follows, radius of FPFH, and how far apart points correspond.
constexpr double kStepD = 0.06, kFineStepD = 0.03, kFeatureRadiusD = 0.3, kReachD = 0.09;
constexpr double kNearestM = 0.1;
constexpr float kFacing = 0.12F;      // least cosine between a normal and the direction to the camera
constexpr std::size_t kFewest = 10;   // points that a pose is judged by
constexpr std::size_t kAligned = 45;  // poses that ICP refines

pcl::PointCloud<pcl::PointNormal>::Ptr ToCloud(const std::vector<OrientedPoint>& points) {
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointNormal>>();
  for (const auto& [p, n] : points) cloud->push_back({p[0], p[1], p[2], n[0], n[1], n[2]});
  return cloud;
}

Eigen::Matrix4f ToMatrix(const FoundPose& pose) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) T(i, j) = pose.R(i, j);
    T(i, 3) = pose.t[i];
  }
  return T.cast<float>();
}

FoundPose FromMatrix(const Eigen::Matrix4f& matrix) {
  const Eigen::Matrix4d T = matrix.cast<double>();
  FoundPose pose;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.R(i, j) = T(i, j);
    pose.t[i] = T(i, 3);
  }
  return pose;
}

// From the corners of a box around the object, those that symmetry makes equal left out.
std::vector<Eigen::Vector3d> ViewDirections(const evaluation::ObjectTruth& object) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d d = Eigen::Vector3d((i & 1) - 0.5, (i & 2) / 2 - 0.5, (i & 4) / 4 - 0.5).normalized();
    const auto same = [&](const Eigen::Vector3d& e) {
      return std::any_of(object.symmetries.begin(), object.symmetries.end(),
                         [&](const evaluation::RigidMm& s) { return (s.R * e).dot(d) > 0.99; });
    };
    if (std::none_of(directions.begin(), directions.end(), same)) directions.push_back(d);
  }
  return directions;
}

}  // namespace

PrerejectiveSearch::PrerejectiveSearch(const mesh::Mesh& mesh, const evaluation::ObjectTruth& object)
    : diameter_m_(object.diameter_mm / 1000) {
  surface_ = ToCloud(Thin(Sample(mesh, 0.006 * diameter_m_), kStepD * diameter_m_));
  for (const Eigen::Vector3d& d : ViewDirections(object)) {
    auto view = pcl::make_shared<Cloud>();
    for (const auto& p : *surface_) {
      if (p.getNormalVector3fMap().cast<double>().dot(d) > static_cast<double>(kFacing)) view->push_back(p);
    }
    views_.push_back(Describe(view));
  }
}

PrerejectiveSearch::Described PrerejectiveSearch::Describe(const Cloud::Ptr& points) const {
  pcl::FPFHEstimation<pcl::PointNormal, pcl::PointNormal, pcl::FPFHSignature33> estimation;
  estimation.setInputCloud(points);
  estimation.setInputNormals(points);
  estimation.setRadiusSearch(kFeatureRadiusD * diameter_m_);
  Described described{points, pcl::make_shared<Features>()};
  estimation.compute(*described.features);
  return described;
}

void PrerejectiveSearch::MatchTile(const Described& tile, std::vector<FoundPose>& poses) const {
  pcl::SampleConsensusPrerejective<pcl::PointNormal, pcl::PointNormal, pcl::FPFHSignature33> alignment;
  alignment.setInputTarget(tile.points);
  alignment.setTargetFeatures(tile.features);
  alignment.setNumberOfSamples(3);
  alignment.setCorrespondenceRandomness(20);  // no more than a tile has points
  alignment.setSimilarityThreshold(0.9F);
  alignment.setMaxCorrespondenceDistance(kReachD * diameter_m_);
  alignment.setMaximumIterations(10000);  // with 4000 it finds a quarter less
  alignment.setInlierFraction(0.4F);
  for (const Described& view : views_) {
    alignment.setInputSource(view.points);
    alignment.setSourceFeatures(view.features);
    Cloud aligned;
    alignment.align(aligned);
    if (!alignment.hasConverged()) continue;
    const FoundPose pose = FromMatrix(alignment.getFinalTransformation());
    if (pose.t[2] > kNearestM) poses.push_back(pose);
  }
}

PrerejectiveSearch::Cloud::Ptr PrerejectiveSearch::Facing(const FoundPose& pose) const {
  Cloud placed;
  pcl::transformPointCloudWithNormals(*surface_, placed, ToMatrix(pose));
  auto facing = pcl::make_shared<Cloud>();
  for (const auto& p : placed) {
    const auto ray = p.getVector3fMap();
    if (p.getNormalVector3fMap().dot(ray) < -kFacing * ray.norm()) facing->push_back(p);
  }
  return facing;
}

double PrerejectiveSearch::InlierFraction(const DenseCloud& cloud, const Target& target, const FoundPose& pose) const {
  const auto facing = Facing(pose);
  if (facing->size() < kFewest) return 0;
  const double tolerance = std::clamp(cloud.DepthSigma(pose.t[2]), 0.03 * diameter_m_, 0.1 * diameter_m_);
  int inliers = 0;
  pcl::Indices nearest(1);
  std::vector<float> squared(1);
  for (const auto& p : *facing) {
    target.tree->nearestKSearch(p, 1, nearest, squared);
    inliers += static_cast<double>(squared[0]) < tolerance * tolerance ? 1 : 0;
  }
  return inliers / static_cast<double>(facing->size());
}

void PrerejectiveSearch::Align(const DenseCloud& cloud, const Target& target, FoundPose& pose) const {
  pcl::IterativeClosestPoint<pcl::PointNormal, pcl::PointNormal> icp;
  icp.setInputTarget(target.points);
  icp.setSearchMethodTarget(target.tree, true);
  icp.setMaxCorrespondenceDistance(kReachD * diameter_m_);
  icp.setMaximumIterations(50);
  FoundPose aligned = pose;
  for (int round = 0; round < 2; ++round) {  // the second one with what faces the camera after the first
    const auto facing = Facing(aligned);
    if (facing->size() < kFewest) return;
    icp.setInputSource(facing);
    Cloud moved;
    icp.align(moved);
    if (!icp.hasConverged()) break;
    aligned = FromMatrix(icp.getFinalTransformation() * ToMatrix(aligned));
    if (!(aligned.t[2] > kNearestM)) return;  // also what is not finite
  }
  aligned.score = InlierFraction(cloud, target, aligned);
  if (aligned.score > pose.score) pose = aligned;
}

std::vector<FoundPose> PrerejectiveSearch::DoFind(const DenseCloud& cloud, std::size_t most) {
  const auto candidates = Candidates(cloud, diameter_m_);
  if (candidates.empty()) return {};
  const auto thin = Thin(candidates, kStepD * diameter_m_);
  const Described scene = Describe(ToCloud(thin));
  const Target target{ToCloud(Thin(candidates, kFineStepD * diameter_m_)), pcl::make_shared<Tree>()};
  target.tree->setInputCloud(target.points);
  std::srand(7);  // of PCL's samples
  std::vector<FoundPose> poses;
  for (const auto& tile : Tiles(thin, diameter_m_)) {
    MatchTile({pcl::make_shared<Cloud>(*scene.points, tile), pcl::make_shared<Features>(*scene.features, tile)}, poses);
  }
  for (FoundPose& p : poses) p.score = InlierFraction(cloud, target, p);
  KeepBest(poses, kAligned);
  for (FoundPose& p : poses) Align(cloud, target, p);
  return KeepApart(std::move(poses), 0.25 * diameter_m_, most);
}

}  // namespace wirepose::bench
