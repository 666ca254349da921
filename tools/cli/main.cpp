// `wirepose`: the host tool. Every subcommand lives in a file of its own and registers itself here.
#include <cstdio>
#include <exception>

#include "command.h"
#include "compare_command.h"
#include "eval_command.h"
#include "model_command.h"
#include "record_command.h"
#include "send_command.h"
#include "sim_command.h"
#include "watch_command.h"

int main(int argc, char** argv) {
  CLI::App app{"Wirepose: model-based 3D object recognition from line features"};
  app.require_subcommand(1);
  wirepose::cli::AddCompareCommand(app);
  wirepose::cli::AddEvalCommand(app);
  wirepose::cli::AddModelCommand(app);
  wirepose::cli::AddRecordCommand(app);
  wirepose::cli::AddSendCommand(app);
  wirepose::cli::AddSimCommand(app);
  wirepose::cli::AddWatchCommand(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help
    std::fprintf(stderr, "wirepose: %s; see 'wirepose --help'\n", e.what());
    return 2;
  } catch (const wirepose::cli::UsageError& e) {
    std::fprintf(stderr, "wirepose: %s\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "wirepose: %s\n", e.what());
    return 1;
  }
  return 0;
}
