// The time that ROS messages carry: when the picture was taken, on the clock that the robot's other programs use.
#ifndef WIREPOSE_APP_STAMP_CLOCK_H_
#define WIREPOSE_APP_STAMP_CLOCK_H_

#include <chrono>
#include <cstdint>

#include "base/time.h"

namespace wirepose::app {

enum class StampSource : std::uint8_t {
  kSystem,   // Unix time, as ROS 2 nodes stamp: what transforms and other sensors go by
  kCapture,  // the camera's own clock, untouched: recorded or simulated time, for nodes with use_sim_time
};

class StampClock {
 public:
  // `capture_is_monotonic`: capture times are CLOCK_MONOTONIC of this machine (a live camera). Otherwise (a recorded or
  // simulated feed) no exposure happened, and the system time of a frame is that of its arrival.
  StampClock(StampSource source, bool capture_is_monotonic)
      : source_(source), capture_is_monotonic_(capture_is_monotonic) {}

  // Call when the frame has arrived. Follows steps of the system clock from the next frame on.
  [[nodiscard]] std::chrono::nanoseconds StampOf(CaptureTime capture_time) const {
    return StampAt(capture_time, SystemNow(), MonotonicNow());
  }
  // The same at a given time on both clocks: for tests.
  [[nodiscard]] std::chrono::nanoseconds StampAt(CaptureTime capture_time, std::chrono::nanoseconds system_now,
                                                 std::chrono::nanoseconds monotonic_now) const {
    const std::chrono::nanoseconds captured = capture_time.time_since_epoch();
    if (source_ == StampSource::kCapture) return captured;
    return capture_is_monotonic_ ? captured + (system_now - monotonic_now) : system_now;
  }

  // Of something that happens now and has no capture time; `last_frame` is the stamp of the last frame.
  [[nodiscard]] std::chrono::nanoseconds StampOfNow(std::chrono::nanoseconds last_frame) const {
    return source_ == StampSource::kCapture ? last_frame : SystemNow();
  }

 private:
  [[nodiscard]] static std::chrono::nanoseconds SystemNow() {
    return std::chrono::system_clock::now().time_since_epoch();
  }
  [[nodiscard]] static std::chrono::nanoseconds MonotonicNow() {
    return std::chrono::steady_clock::now().time_since_epoch();  // CLOCK_MONOTONIC on Linux
  }

  StampSource source_;
  bool capture_is_monotonic_;
};

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_STAMP_CLOCK_H_
