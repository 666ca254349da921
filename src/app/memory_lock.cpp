#include "app/memory_lock.h"

#include <sys/mman.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstring>

namespace wirepose::app {

std::string LockMemory() {
  // Under a limit, locking the future would make allocations fail later instead of here.
  rlimit limit{};
  const bool unlimited = getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
  if (mlockall(unlimited ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT) == 0) return {};
  return std::string("memory is not locked (") + std::strerror(errno) +
         "), page faults may delay frames; set LimitMEMLOCK=infinity in the systemd unit or ulimit -l unlimited";
}

}  // namespace wirepose::app
