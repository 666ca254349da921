// `wirepose sim`: pictures of worlds that do not exist, with the truth about them.
#ifndef WIREPOSE_TOOLS_CLI_SIM_COMMAND_H_
#define WIREPOSE_TOOLS_CLI_SIM_COMMAND_H_

#include <CLI/CLI.hpp>

namespace wirepose::cli {

// Adds `sim render --out DIR [--scenario FILE]` and `sim suite --out DIR [--only NAME]`. Throws as
// command.h says.
void AddSimCommand(CLI::App& app);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_SIM_COMMAND_H_
