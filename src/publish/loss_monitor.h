// Tells losses that go on from those that are over.
#ifndef WIREPOSE_PUBLISH_LOSS_MONITOR_H_
#define WIREPOSE_PUBLISH_LOSS_MONITOR_H_

#include <chrono>
#include <cstdint>

#include "publish/reports.h"

namespace wirepose {

// What was lost lately.
struct RecentLosses {
  bool results = false;     // given up, because the bus was slower than the camera
  bool messages = false;    // refused by DDS
  bool detections = false;  // beyond what a message can hold
};

// Health counts losses since the start; a robot monitor must be calm again once they have stopped. Reads no clock: a
// report's uptime says when it was made. Not thread safe.
class LossMonitor {
 public:
  // Long enough to be seen by somebody who looks up now and then.
  static constexpr std::chrono::seconds kMemory{30};

  // Of each report, in the order of their uptimes.
  RecentLosses Update(const HealthReport& report) {
    const std::chrono::nanoseconds now(report.uptime_ns);
    return {results_.Update(report.results_dropped, now), messages_.Update(report.write_errors, now),
            detections_.Update(report.lists.detections.dropped, now)};
  }

 private:
  class Counter {
   public:
    // Has it grown within kMemory?
    bool Update(std::uint64_t count, std::chrono::nanoseconds now) {
      if (count > count_) grew_ = now;
      count_ = count;
      return count > 0 && now - grew_ < kMemory;
    }

   private:
    std::uint64_t count_ = 0;
    std::chrono::nanoseconds grew_{0};
  };

  Counter results_, messages_, detections_;
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_LOSS_MONITOR_H_
