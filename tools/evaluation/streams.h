// What a subscriber received against what the simulated camera knew, both as JSON, one object a
// line.
#ifndef WIREPOSE_TOOLS_EVALUATION_STREAMS_H_
#define WIREPOSE_TOOLS_EVALUATION_STREAMS_H_

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "tools/evaluation/metrics.h"
#include "tools/evaluation/model_set.h"

namespace wirepose::evaluation {

// The truth that hal/simulated writes: {"sequence", "objects": [{"obj_id", "R", "t" [m],
// "visib_fract"}]}. Gives ground truth of one scene (0) whose image ids are the frames' sequence
// numbers. The models say size and symmetry; objects that no model has are left out, for the
// recognizer was not asked for them. Error: "file:line: what; remedy".
Result<GroundTruth, std::string> ReadTruthStream(const std::filesystem::path& file, const ModelSet& models);

// What `wirepose watch --json` prints of the topic wirepose/recognition; lines of other topics are
// passed over.
struct Received {
  // (0, sequence) of every message, also of those without detection.
  std::set<std::pair<int, int>> frames;
  std::vector<Estimate> estimates;  // scene 0, image id = sequence
};
Result<Received, std::string> ReadReceivedStream(const std::filesystem::path& file);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_STREAMS_H_
