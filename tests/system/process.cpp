#include "process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace wirepose::test {
namespace {

std::string ReadFile(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

// The program and what runs it: tests for another processor start their own programs under an emulator, too.
std::vector<std::string> Runnable(const std::vector<std::string>& command) {
  std::vector<std::string> runnable;
#ifdef WIREPOSE_TEST_EMULATOR
  const bool ours = command.at(0).rfind("/usr/", 0) != 0;  // not the machine's
  std::istringstream emulator(ours ? WIREPOSE_TEST_EMULATOR : "");
  for (std::string word; emulator >> word;) runnable.push_back(word);
#endif
  runnable.insert(runnable.end(), command.begin(), command.end());
  return runnable;
}

}  // namespace

Process::Process(const std::filesystem::path& folder, const std::string& name, const std::vector<std::string>& command,
                 const std::vector<std::string>& environment)
    : out_(folder / (name + ".out")), err_(folder / (name + ".err")) {
  std::vector<std::string> arguments = Runnable(command);
  std::vector<std::string> variables = environment;
  for (char** v = environ; *v != nullptr; ++v) variables.emplace_back(*v);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kCreate = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_.c_str(), kCreate, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err_.c_str(), kCreate, 0600);
  const int error = posix_spawn(&pid_, arguments.at(0).c_str(), &actions, nullptr, Pointers(arguments).data(),
                                Pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error("cannot start " + command[0]);
}

Process::~Process() {
  if (status_) return;
  Signal(SIGKILL);
  waitpid(pid_, nullptr, 0);
}

void Process::Signal(int signal) const { kill(pid_, signal); }

std::optional<int> Process::Wait(std::chrono::seconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!status_ && std::chrono::steady_clock::now() < end) {
    int raw = 0;
    if (waitpid(pid_, &raw, WNOHANG) == pid_) {
      status_ = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  return status_;
}

std::string Process::Out() const { return ReadFile(out_); }

std::string Process::Err() const { return ReadFile(err_); }

std::vector<std::string> Process::OutLines() const {
  std::vector<std::string> lines;
  std::istringstream text(Out());
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

}  // namespace wirepose::test
