// PCL's SampleConsensusPrerejective on FPFH features, then IterativeClosestPoint.
#ifndef WIREPOSE_TESTS_BENCH_PEER_PCL_PREREJECTIVE_SEARCH_H_
#define WIREPOSE_TESTS_BENCH_PEER_PCL_PREREJECTIVE_SEARCH_H_

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include "oriented_points.h"
#include "peer.h"

namespace wirepose::bench {

// One object. Source: Buch et al., "Pose estimation using local structure-specific shape and appearance context", ICRA
// 2013, and Rusu et al., "Fast point feature histograms (FPFH) for 3D registration", ICRA 2009, as PCL 1.13 implements
// them. The help, most of it what peer_ppf gets:
// - model and scene are thinned by a voxel grid in proportion to the object's diameter, points of different orientation
//   kept apart; the scene ends at the range of usable depth and has normals fitted to the disparity's noise;
// - points on planes larger than the object are left out;
// - the scene is searched in tiles of the object's size, so that more of the random samples lie on the object;
// - the model is aligned as it is seen from each corner of its box (modulo symmetry), without its back, which no
//   camera sees and which looks different to FPFH;
// - the 45 best poses go through ICP, on a finer cloud and with the surface that faces the camera; the score is the
//   inlier fraction of that surface: the share that lies on the cloud.
class PrerejectiveSearch : public ObjectSearch {
 public:
  PrerejectiveSearch(const mesh::Mesh& mesh, const evaluation::ObjectTruth& object);

 private:
  using Cloud = pcl::PointCloud<pcl::PointNormal>;
  using Features = pcl::PointCloud<pcl::FPFHSignature33>;
  using Tree = pcl::search::KdTree<pcl::PointNormal>;

  // Points with a description of each one's surroundings.
  struct Described {
    Cloud::Ptr points;
    Features::Ptr features;
  };
  // What poses are aligned to and judged by: a finer cloud.
  struct Target {
    Cloud::Ptr points;
    Tree::Ptr tree;
  };

  std::vector<FoundPose> DoFind(const DenseCloud& cloud, std::size_t most) override;
  [[nodiscard]] Described Describe(const Cloud::Ptr& points) const;
  // Adds the best pose of each view in the part of the scene.
  void MatchTile(const Described& tile, std::vector<FoundPose>& poses) const;
  void Align(const DenseCloud& cloud, const Target& target, FoundPose& pose) const;
  // Share of the surface facing the camera that lies on the cloud.
  [[nodiscard]] double InlierFraction(const DenseCloud& cloud, const Target& target, const FoundPose& pose) const;
  [[nodiscard]] Cloud::Ptr Facing(const FoundPose& pose) const;

  double diameter_m_;
  Cloud::Ptr surface_;
  std::vector<Described> views_;
};

}  // namespace wirepose::bench

#endif  // WIREPOSE_TESTS_BENCH_PEER_PCL_PREREJECTIVE_SEARCH_H_
