#include "app/stamp_clock.h"

#include <gtest/gtest.h>

namespace wirepose::app {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::nanoseconds kUnix = 1'700'000'000s, kMonotonic = 5000s;
const CaptureTime kCaptured{4999s + 990ms};  // 10 ms ago

TEST(StampClock, LiveCameraIsMovedToTheSystemClock) {
  EXPECT_EQ(StampClock(StampSource::kSystem, true).StampAt(kCaptured, kUnix, kMonotonic), kUnix - 10ms);
}

TEST(StampClock, RecordedFrameIsStampedOnArrival) {
  EXPECT_EQ(StampClock(StampSource::kSystem, false).StampAt(CaptureTime{40ms}, kUnix, kMonotonic), kUnix);
}

TEST(StampClock, CaptureTimeIsLeftAloneWhenAskedFor) {
  for (const bool live : {true, false}) {
    const StampClock clock(StampSource::kCapture, live);
    EXPECT_EQ(clock.StampAt(CaptureTime{40ms}, kUnix, kMonotonic), 40ms);
    EXPECT_EQ(clock.StampOfNow(40ms), 40ms);
  }
}

TEST(StampClock, StepsOfTheSystemClockAreFollowed) {
  const StampClock clock(StampSource::kSystem, true);
  EXPECT_EQ(clock.StampAt(kCaptured, kUnix - 3600s, kMonotonic), kUnix - 3600s - 10ms);
}

}  // namespace
}  // namespace wirepose::app
