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

// The scripts stand beside the packages: node looks for them from the script's folder upward.
inline std::vector<std::string> NodeCommand(const std::string& script, const std::vector<std::string>& arguments) {
  const std::filesystem::path packages(WIREPOSE_NPM);
  std::vector<std::string> command = {"/usr/bin/env", "node", (packages / script).string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_ROS2_NODE_H_
