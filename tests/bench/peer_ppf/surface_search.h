// OpenCV's surface_matching (point-pair features and ICP) with all the help that was found to help it.
#ifndef WIREPOSE_TESTS_BENCH_PEER_PPF_SURFACE_SEARCH_H_
#define WIREPOSE_TESTS_BENCH_PEER_PPF_SURFACE_SEARCH_H_

#include <opencv2/surface_matching.hpp>

#include "dense_cloud.h"
#include "mesh/mesh.h"
#include "tools/evaluation/ground_truth.h"

namespace wirepose::bench {

struct SurfacePose {
  cv::Matx33d R = cv::Matx33d::eye();  // T_rectified_model; m
  cv::Vec3d t;
  double score = 0;  // before verification votes, then agreement with the cloud in -1..1
};

// One object. Source: Drost et al., "Model globally, match locally", CVPR 2010, as OpenCV 4.6 implements it. The help:
// points on planes larger than the object are left out; the scene is searched in tiles of the object's size; poses are
// clustered modulo symmetry; they are ranked by how much of the visible surface lies on the cloud, before and after
// ICP.
class SurfaceSearch {
 public:
  // Trains; takes up to some seconds.
  SurfaceSearch(const mesh::Mesh& mesh, const evaluation::ObjectTruth& object);

  // At most `most` poses, no two at one place, best first.
  [[nodiscard]] std::vector<SurfacePose> Find(const DenseCloud& cloud, std::size_t most);

 private:
  // Gives access to the points that the poses refer to.
  struct Detector : cv::ppf_match_3d::PPF3DDetector {
    using PPF3DDetector::PPF3DDetector;
    [[nodiscard]] const cv::Mat& points() const { return sampled_pc; }
  };

  void MatchTile(const std::vector<OrientedPoint>& tile, std::vector<SurfacePose>& poses);
  [[nodiscard]] std::vector<SurfacePose> Cluster(std::vector<SurfacePose> poses) const;
  void Align(const DenseCloud& cloud, const std::vector<OrientedPoint>& scene, SurfacePose& pose) const;
  // Agreement of the visible surface with the cloud; `visible` (may be null) receives the visible points, model frame.
  double Verify(const DenseCloud& cloud, const SurfacePose& pose, double tolerance_factor,
                std::vector<OrientedPoint>* visible) const;
  [[nodiscard]] double TurnBetween(const cv::Matx33d& a, const cv::Matx33d& b) const;

  double diameter_m_, step_;  // step: sampling, in diameters
  std::vector<cv::Matx33d> symmetries_;
  std::vector<OrientedPoint> surface_;  // for verification
  Detector detector_;
};

}  // namespace wirepose::bench

#endif  // WIREPOSE_TESTS_BENCH_PEER_PPF_SURFACE_SEARCH_H_
