// `wirepose watch`: subscribes to a robot and prints what it says.
#ifndef WIREPOSE_TOOLS_CLI_WATCH_COMMAND_H_
#define WIREPOSE_TOOLS_CLI_WATCH_COMMAND_H_

#include "command.h"

namespace wirepose::cli {

// Adds the subcommand. With --json it prints one object a line; the keys are those of the IDL files
// in dds_idl, led by "topic" (recognition, detections or health). Fails with WorkFailed when
// nothing arrives in time.
void AddWatchCommand(CLI::App& app);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_WATCH_COMMAND_H_
