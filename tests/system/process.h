// A program under test as a process of its own.
#ifndef WIREPOSE_TESTS_SYSTEM_PROCESS_H_
#define WIREPOSE_TESTS_SYSTEM_PROCESS_H_

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace wirepose::test {

// Starts at construction; is killed at destruction if it still runs. Output goes to files, so that
// it never blocks.
class Process {
 public:
  // `environment`: "NAME=value" lines added to this process's.
  Process(const std::filesystem::path& folder, const std::string& name, const std::vector<std::string>& command,
          const std::vector<std::string>& environment = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void Signal(int signal) const;
  // Exit status (128 + signal when a signal ended it); nothing when it still runs after `limit`.
  std::optional<int> Wait(std::chrono::seconds limit = std::chrono::seconds(30));

  [[nodiscard]] std::string Out() const;
  [[nodiscard]] std::string Err() const;
  [[nodiscard]] std::vector<std::string> OutLines() const;

 private:
  std::filesystem::path out_, err_;
  pid_t pid_ = -1;
  std::optional<int> status_;
};

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_SYSTEM_PROCESS_H_
