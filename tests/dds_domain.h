// A DDS domain that no other test on this machine uses at the same time.
#ifndef WIREPOSE_TESTS_DDS_DOMAIN_H_
#define WIREPOSE_TESTS_DDS_DOMAIN_H_

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace wirepose::test {

// Takes one of the domains 100 to 229 by locking a file of its name; the kernel unlocks it when
// this process ends, however it ends.
class DdsDomain {
 public:
  DdsDomain() {
    for (std::uint32_t i = 0; i < 130; ++i) {
      id_ = 100 + (static_cast<std::uint32_t>(getpid()) + i) % 130;
      const std::string path =
          (std::filesystem::temp_directory_path() / ("wirepose_dds_domain_" + std::to_string(id_) + ".lock"));
      file_ = open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
      if (file_ >= 0 && flock(file_, LOCK_EX | LOCK_NB) == 0) return;
      if (file_ >= 0) close(file_);
    }
    throw std::runtime_error("every DDS domain is taken");
  }
  ~DdsDomain() { close(file_); }
  DdsDomain(const DdsDomain&) = delete;
  DdsDomain& operator=(const DdsDomain&) = delete;

  [[nodiscard]] std::uint32_t id() const { return id_; }

 private:
  std::uint32_t id_ = 0;
  int file_ = -1;
};

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_DDS_DOMAIN_H_
