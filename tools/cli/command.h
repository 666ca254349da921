// How a subcommand of `wirepose` reports: 0 done, 1 the work failed, 2 usage.
#ifndef WIREPOSE_TOOLS_CLI_COMMAND_H_
#define WIREPOSE_TOOLS_CLI_COMMAND_H_

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <string>

namespace wirepose::cli {

// The work failed: `what()` names file, place and remedy in one line. main() prints it and exits with 1.
struct WorkFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The command line or a file it names is wrong: as above, exit status 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_COMMAND_H_
