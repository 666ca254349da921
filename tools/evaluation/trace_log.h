// The fate of every true instance as a table: at which stage it was lost, and how near each stage came.
#ifndef WIREPOSE_TOOLS_EVALUATION_TRACE_LOG_H_
#define WIREPOSE_TOOLS_EVALUATION_TRACE_LOG_H_

#include <fstream>

#include "tools/evaluation/evaluate.h"

namespace wirepose::evaluation {

// Writes one CSV row an instance that was searched for. Errors are in diameters, 9 where a stage had nothing; ranks
// count from 0; the candidate's rank counts all models.
class TraceLog {
 public:
  explicit TraceLog(const std::filesystem::path& file);
  void Add(const FrameView& view);

 private:
  std::ofstream out_;
};

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_TRACE_LOG_H_
