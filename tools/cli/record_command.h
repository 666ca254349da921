// `wirepose record`: writes what is on the bus into an MCAP file.
#ifndef WIREPOSE_TOOLS_CLI_RECORD_COMMAND_H_
#define WIREPOSE_TOOLS_CLI_RECORD_COMMAND_H_

#include "command.h"

namespace wirepose::cli {

void AddRecordCommand(CLI::App& app);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_RECORD_COMMAND_H_
