// Results files as BOP defines them: scene_id,im_id,obj_id,score,R,t,time.
#ifndef WIREPOSE_TOOLS_EVALUATION_RESULTS_CSV_H_
#define WIREPOSE_TOOLS_EVALUATION_RESULTS_CSV_H_

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "tools/evaluation/metrics.h"

namespace wirepose::evaluation {

// R row-major, 9 numbers separated by blanks; t 3 numbers in mm; both map the model into the raw
// left camera. Numbers are written with as many digits as it takes to read back the same double.
// Replaces the file. Error: one line.
Result<void, std::string> WriteResults(const std::filesystem::path& file, std::span<const Estimate> estimates);

// Reads what WriteResults writes and other programs' files of that format; `time` may be absent.
// Error: "file:line: ...".
Result<std::vector<Estimate>, std::string> ReadResults(const std::filesystem::path& file);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_RESULTS_CSV_H_
