// Scenario files: YAML that a person writes. README.md lists every key; scenario_spec.h says what
// holds for those left out.
#ifndef WIREPOSE_SIM_SCENARIO_FILE_H_
#define WIREPOSE_SIM_SCENARIO_FILE_H_

#include <filesystem>
#include <string>

#include "base/result.h"
#include "sim/scenario_spec.h"

namespace wirepose::sim {

// The name is the file's without extension. Unknown keys are refused. The error is one line:
// "file:line: key: reason and remedy".
[[nodiscard]] Result<ScenarioSpec, std::string> ReadScenario(const std::filesystem::path& file);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SCENARIO_FILE_H_
