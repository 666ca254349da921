// What systemd wants to hear: ready, alive, stopping. Does nothing outside systemd or in a build
// without libsystemd.
#ifndef WIREPOSE_APP_SERVICE_H_
#define WIREPOSE_APP_SERVICE_H_

#include <chrono>
#include <optional>
#include <string>

namespace wirepose::app {

// Not thread safe.
class Service {
 public:
  using Clock = std::chrono::steady_clock;

  Service();
  void Ready(const std::string& status);
  // Call at least once a second from the loop that must be alive; sends at most four times a
  // watchdog period.
  void Alive(Clock::time_point now);
  void Stopping();

 private:
  std::optional<std::chrono::microseconds> watchdog_period_;
  std::optional<Clock::time_point> last_alive_;
};

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_SERVICE_H_
