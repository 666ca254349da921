// `wirepose compare`: poses that arrived over DDS against the simulated scene's truth.
#ifndef WIREPOSE_TOOLS_CLI_COMPARE_COMMAND_H_
#define WIREPOSE_TOOLS_CLI_COMPARE_COMMAND_H_

#include <CLI/CLI.hpp>

namespace wirepose::cli {

// Registers the subcommand; its callback throws WorkFailed or UsageError (command.h).
void AddCompareCommand(CLI::App& app);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_COMPARE_COMMAND_H_
