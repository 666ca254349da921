// What all subcommands that join the bus share on the command line.
#ifndef WIREPOSE_TOOLS_CLI_BUS_OPTIONS_H_
#define WIREPOSE_TOOLS_CLI_BUS_OPTIONS_H_

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "publish/bus.h"

namespace wirepose::cli {

struct BusOptions {
  std::uint32_t domain = 0;
  bool loopback = false;
  bool best_effort = false;
  unsigned deadline_ms = 0;        // asked of wirepose/recognition; 0: none
  std::vector<std::string> names;  // KEY=NAME
  std::string security;            // a participant's folder; empty: none
};

// --domain, --loopback, --name, --best-effort, --security.
void AddBusOptions(CLI::App& command, BusOptions& options);

// Throws UsageError when a name is given for no topic or the folder of --security lacks a file.
BusConfig BusConfigOf(const BusOptions& options);

// Throws WorkFailed.
Bus OpenBus(const BusOptions& options);
dds_entity_t OpenReader(const Bus& bus, TopicId topic);

// "DDS domain 5 (loopback)", for messages.
std::string Where(const BusOptions& options);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_BUS_OPTIONS_H_
