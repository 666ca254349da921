// Runs the scripts of this folder, which use npm packages.
#ifndef WIREPOSE_TESTS_ROS2_NODE_H_
#define WIREPOSE_TESTS_ROS2_NODE_H_

#include <filesystem>
#include <string>
#include <vector>

#include "../system/process.h"

namespace wirepose::test {

// Were node and the packages to be had when the tests were set up (npm_packages.cmake)?
inline bool NodeIsThere() { return std::filesystem::exists(std::filesystem::path(WIREPOSE_NPM) / "installed"); }

// Node looks for packages from the script's folder upward: the scripts run as copies beside the packages.
inline std::vector<std::string> NodeCommand(const std::string& script, const std::vector<std::string>& arguments) {
  const std::filesystem::path packages(WIREPOSE_NPM);
  for (const auto& entry : std::filesystem::directory_iterator(WIREPOSE_NODE_SCRIPTS)) {
    if (entry.path().extension() != ".mjs") continue;
    std::filesystem::copy_file(entry.path(), packages / entry.path().filename(),
                               std::filesystem::copy_options::overwrite_existing);
  }
  std::vector<std::string> command = {"/usr/bin/env", "node", (packages / script).string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_ROS2_NODE_H_
