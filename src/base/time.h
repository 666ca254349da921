// Time as data. Nothing below src/app reads a clock; whoever captures a frame stamps it.
#ifndef WIREPOSE_BASE_TIME_H_
#define WIREPOSE_BASE_TIME_H_

#include <chrono>
#include <cstdint>

namespace wirepose {

// The clock of capture times: nanoseconds on the camera's time base, CLOCK_MONOTONIC on Linux. It has no now():
// only a HAL backend knows the time.
struct CaptureClock {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = std::chrono::nanoseconds;
  using time_point = std::chrono::time_point<CaptureClock>;
  static constexpr bool is_steady = true;
};

using CaptureTime = CaptureClock::time_point;

}  // namespace wirepose

#endif  // WIREPOSE_BASE_TIME_H_
