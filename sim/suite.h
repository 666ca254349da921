// Renders scenarios into data sets: all cores, resumable, nothing twice.
#ifndef WIREPOSE_SIM_SUITE_H_
#define WIREPOSE_SIM_SUITE_H_

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/scenario_spec.h"
#include "sim/target_mesh.h"

namespace wirepose::sim {

// One scenario and the folder of its data set.
struct RenderJob {
  ScenarioSpec spec;
  std::filesystem::path root;
};

struct RenderProgress {
  int done = 0, reused = 0, total = 0;  // frames; `reused` were there before
  double elapsed_s = 0;
  double left_s = 0;  // estimate; 0 when nothing was rendered yet
  std::string name;   // of the scenario of the frame just done
};

// Called after each frame, one call at a time, on any thread.
using ProgressListener = std::function<void(const RenderProgress&)>;

// Renders what is missing: a scene whose truth is written is complete and stays; a data set that was
// rendered from another scenario, other meshes or another simulator (content_hash.txt) is removed
// and rendered anew. A folder that holds anything else is refused. Writes contact_sheet.png beside
// each finished data set. Bytes do not depend on `threads`. The error is one line.
[[nodiscard]] Result<void, std::string> RenderDatasets(const std::vector<RenderJob>& jobs,
                                                       const std::vector<TargetMesh>& targets, int threads,
                                                       const ProgressListener& listener);

// Sixteen hexadecimal digits of everything that a data set's bytes depend on.
[[nodiscard]] std::string ContentHash(const ScenarioSpec& spec, const std::vector<TargetMesh>& targets);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SUITE_H_
