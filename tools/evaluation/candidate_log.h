// Every verified candidate with its evidence and whether it is right: what the score is fitted to.
#ifndef WIREPOSE_TOOLS_EVALUATION_CANDIDATE_LOG_H_
#define WIREPOSE_TOOLS_EVALUATION_CANDIDATE_LOG_H_

#include <fstream>

#include "tools/evaluation/evaluate.h"

namespace wirepose::evaluation {

// Writes one CSV row a candidate. `error_d` is the smallest vertex distance (MSSD over the model's discrete symmetries)
// to a true instance of the same object, in diameters; 9 where there is none.
class CandidateLog {
 public:
  explicit CandidateLog(const std::filesystem::path& file);
  void Add(const FrameView& view);
  [[nodiscard]] bool ok() const { return out_.good(); }

 private:
  std::ofstream out_;
};

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_CANDIDATE_LOG_H_
