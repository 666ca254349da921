// `wirepose eval`: how well the recognizer does on a data set.
#ifndef WIREPOSE_TOOLS_CLI_EVAL_COMMAND_H_
#define WIREPOSE_TOOLS_CLI_EVAL_COMMAND_H_

#include <CLI/CLI.hpp>

namespace wirepose::cli {

// Registers the subcommand; its callback throws WorkFailed or UsageError (command.h).
void AddEvalCommand(CLI::App& app);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_EVAL_COMMAND_H_
