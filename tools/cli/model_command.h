// `wirepose model build|show`: makes line models from meshes and looks at them.
#ifndef WIREPOSE_TOOLS_CLI_MODEL_COMMAND_H_
#define WIREPOSE_TOOLS_CLI_MODEL_COMMAND_H_

#include "command.h"

namespace wirepose::cli {

// Registers the subcommand; its work runs in CLI11's callback and reports by the exceptions of
// command.h.
void AddModelCommand(CLI::App& app);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_MODEL_COMMAND_H_
