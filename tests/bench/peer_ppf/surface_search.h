// OpenCV's surface_matching (point-pair features and ICP) with all the help that was found to help it.
#ifndef WIREPOSE_TESTS_BENCH_PEER_PPF_SURFACE_SEARCH_H_
#define WIREPOSE_TESTS_BENCH_PEER_PPF_SURFACE_SEARCH_H_

#include <opencv2/surface_matching.hpp>

#include "oriented_points.h"
#include "peer.h"

namespace wirepose::bench {

// One object. Source: Drost et al., "Model globally, match locally", CVPR 2010, as OpenCV 4.6 implements it. The help:
// points on planes larger than the object are left out; the scene is searched in tiles of the object's size; poses are
// clustered modulo symmetry; they are ranked by how much of the visible surface lies on the cloud, before and after
// ICP.
class SurfaceSearch : public ObjectSearch {
 public:
  // Trains; takes up to some seconds.
  SurfaceSearch(const mesh::Mesh& mesh, const evaluation::ObjectTruth& object);

 private:
  // Gives access to the points that the poses refer to.
  struct Detector : cv::ppf_match_3d::PPF3DDetector {
    using PPF3DDetector::PPF3DDetector;
    [[nodiscard]] const cv::Mat& points() const { return sampled_pc; }
  };

  std::vector<FoundPose> DoFind(const DenseCloud& cloud, std::size_t most) override;
  // Adds poses whose score are votes; after Verify it is agreement with the cloud in -1..1.
  void MatchTile(const std::vector<OrientedPoint>& tile, std::vector<FoundPose>& poses);
  [[nodiscard]] std::vector<FoundPose> Cluster(std::vector<FoundPose> poses) const;
  void Align(const DenseCloud& cloud, const std::vector<OrientedPoint>& scene, FoundPose& pose) const;
  // Agreement of the visible surface with the cloud; `visible` (may be null) receives the visible points, model frame.
  double Verify(const DenseCloud& cloud, const FoundPose& pose, double tolerance_factor,
                std::vector<OrientedPoint>* visible) const;
  [[nodiscard]] double TurnBetween(const cv::Matx33d& a, const cv::Matx33d& b) const;

  double diameter_m_, step_;  // step: sampling, in diameters
  std::vector<cv::Matx33d> symmetries_;
  std::vector<OrientedPoint> surface_;  // for verification
  Detector detector_;
};

}  // namespace wirepose::bench

#endif  // WIREPOSE_TESTS_BENCH_PEER_PPF_SURFACE_SEARCH_H_
