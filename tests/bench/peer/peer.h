// A public recognizer as a program that runs on a data set: all that is not the recognizer itself.
//
// PROGRAM DATASET --out results.csv --json metrics.json [--limit N]
//
// Every object of the data set is searched for in every frame, up to three poses each. The rows written are those above
// the score that, known afterwards, gives the best harmonic mean of recall and precision: kinder than any user could
// be.
#ifndef WIREPOSE_TESTS_BENCH_PEER_PEER_H_
#define WIREPOSE_TESTS_BENCH_PEER_PEER_H_

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "dense_cloud.h"
#include "mesh/mesh.h"
#include "tools/evaluation/ground_truth.h"

namespace wirepose::bench {

struct FoundPose {
  cv::Matx33d R = cv::Matx33d::eye();  // T_rectified_model; m
  cv::Vec3d t;
  double score = 0;
};

// Best first, at most `most`.
void KeepBest(std::vector<FoundPose>& poses, std::size_t most);

// The best poses, at most `most`, no two nearer than `distance_m`.
std::vector<FoundPose> KeepApart(std::vector<FoundPose> poses, double distance_m, std::size_t most);

// A recognizer that was taught one object.
class ObjectSearch {
 public:
  ObjectSearch() = default;
  ObjectSearch(const ObjectSearch&) = delete;
  ObjectSearch& operator=(const ObjectSearch&) = delete;
  virtual ~ObjectSearch() = default;
  // At most `most` poses, no two at one place, best first.
  [[nodiscard]] std::vector<FoundPose> Find(const DenseCloud& cloud, std::size_t most) { return DoFind(cloud, most); }

 private:
  virtual std::vector<FoundPose> DoFind(const DenseCloud& cloud, std::size_t most) = 0;
};

using TrainFunction =
    std::function<std::unique_ptr<ObjectSearch>(const mesh::Mesh& mesh, const evaluation::ObjectTruth& object)>;

// The whole program; gives its exit status. Works in one thread and states CPU time. Errors: one line on stderr.
int PeerMain(int argc, char** argv, const char* program, const char* description, const TrainFunction& train);

}  // namespace wirepose::bench

#endif  // WIREPOSE_TESTS_BENCH_PEER_PEER_H_
