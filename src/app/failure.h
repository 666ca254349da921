// How the robot program ends when it cannot do its work. what() is one line: file, place, reason
// and remedy.
#ifndef WIREPOSE_APP_FAILURE_H_
#define WIREPOSE_APP_FAILURE_H_

#include <stdexcept>

namespace wirepose::app {

// The command line or the configuration is wrong: exit status 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The work failed: exit status 1.
struct WorkFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_FAILURE_H_
