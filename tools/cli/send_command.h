// `wirepose command`: tells a running wireposed what to do and prints its answer.
#ifndef WIREPOSE_TOOLS_CLI_SEND_COMMAND_H_
#define WIREPOSE_TOOLS_CLI_SEND_COMMAND_H_

#include "command.h"

namespace wirepose::cli {

void AddSendCommand(CLI::App& app);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_SEND_COMMAND_H_
