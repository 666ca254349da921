// Keeps the program's memory in RAM, so that no frame waits for a page from the disk.
#ifndef WIREPOSE_APP_MEMORY_LOCK_H_
#define WIREPOSE_APP_MEMORY_LOCK_H_

#include <string>

namespace wirepose::app {

// Locks every page that the process has, with the thread stacks, and where the limit of locked memory allows any size
// (root, or systemd's LimitMEMLOCK=infinity) those to come. Call it when all is set up. Empty on success, else one
// line: what failed and what to do; the program works without.
[[nodiscard]] std::string LockMemory();

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_MEMORY_LOCK_H_
