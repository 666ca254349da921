// A small random data set with exact truth, and detections of every kind for it.
#ifndef WIREPOSE_TESTS_TOOLS_EVAL_DATASET_H_
#define WIREPOSE_TESTS_TOOLS_EVAL_DATASET_H_

#include <filesystem>
#include <random>
#include <vector>

#include "tools/evaluation/metrics.h"

namespace wirepose::evaluation::testing {

// A folder that is gone when the object is.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void WriteText(const std::filesystem::path& file, const std::string& text);

Matrix3d RandomRotation(std::mt19937& random);

// Writes models (a cuboid with its three turns, a lump without symmetry as binary PLY, a cone with
// a continuous symmetry off its origin) and scenes with 0 to 4 instances a frame, of all
// visibilities. No images.
void WriteRandomDataset(const std::filesystem::path& root, std::mt19937& random);

// Near, symmetric, far, doubled, equally scored, behind the camera, of an unknown object, of an
// unknown frame.
std::vector<Estimate> RandomEstimates(const GroundTruth& truth, std::mt19937& random);

}  // namespace wirepose::evaluation::testing

#endif  // WIREPOSE_TESTS_TOOLS_EVAL_DATASET_H_
