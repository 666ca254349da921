#include "app/stage_timer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string_view>
#include <vector>

namespace wirepose::app {
namespace {

using std::chrono::nanoseconds;

StageTimer::Clock::time_point At(std::int64_t ns) { return StageTimer::Clock::time_point(nanoseconds(ns)); }

TEST(StageTimer, NoFrameNoTimes) { EXPECT_TRUE(StageTimer().Summary().empty()); }

TEST(StageTimer, StagesThatDidNotRunAreLeftOut) {
  StageTimer timer;
  timer.FrameBegins(At(100));
  timer.StageDoneAt(Stage::kRectify, At(130));
  timer.StageDoneAt(Stage::kSelect, At(131));
  timer.FrameEnds(At(150));
  const StageTimes times = timer.Summary();
  ASSERT_EQ(times.size(), 3u);
  EXPECT_TRUE(times[0].stage == "rectify");
  EXPECT_EQ(times[0].max_ns, 30u);
  EXPECT_TRUE(times[1].stage == "select");
  EXPECT_EQ(times[1].max_ns, 1u);
  EXPECT_TRUE(times[2].stage == "frame");
  EXPECT_EQ(times[2].max_ns, 50u);
}

// The stages after the line sets run once for each model.
TEST(StageTimer, RunsOfOneFrameAddUp) {
  StageTimer timer;
  for (const std::int64_t begin : {1000, 2000}) {
    timer.FrameBegins(At(begin));
    for (const std::int64_t model : {0, 100, 200}) {
      timer.StageDoneAt(Stage::kHypotheses, At(begin + model + 70));
      timer.StageDoneAt(Stage::kVerify, At(begin + model + 100));
    }
    timer.FrameEnds(At(begin + 300));
  }
  const StageTimes times = timer.Summary();
  ASSERT_EQ(times.size(), 3u);
  EXPECT_EQ(times[0].max_ns, 3 * 70u);
  EXPECT_EQ(times[1].max_ns, 3 * 30u);
  EXPECT_EQ(times[2].max_ns, 300u);
}

TEST(StageTimer, AStageOfNoTimeStillRan) {
  StageTimer timer;
  timer.FrameBegins(At(0));
  timer.StageDoneAt(Stage::kRectify, At(0));
  timer.FrameEnds(At(0));
  EXPECT_EQ(timer.Summary().size(), 2u);
}

// Against sorting the last kWindow durations; more frames than the window holds.
TEST(StageTimer, PercentilesAgreeWithSorting) {
  std::mt19937 random(8);
  StageTimer timer;
  std::vector<std::uint64_t> all;
  std::int64_t now = 0;
  for (int frame = 0; frame < 700; ++frame) {
    const auto duration = static_cast<std::int64_t>(random() % 1'000'000);
    timer.FrameBegins(At(now));
    timer.StageDoneAt(Stage::kVerify, At(now + duration));
    timer.FrameEnds(At(now + duration));
    now += duration + 5;
    all.push_back(static_cast<std::uint64_t>(duration));
    if (frame % 37 != 0 && frame != 699) continue;
    const std::size_t count = std::min(all.size(), StageTimer::kWindow);
    std::vector<std::uint64_t> window(all.end() - static_cast<std::ptrdiff_t>(count), all.end());
    std::sort(window.begin(), window.end());
    const StageTimes times = timer.Summary();
    ASSERT_EQ(times.size(), 2u);
    for (const StageTime& time : times) {
      EXPECT_EQ(time.p50_ns, window[(count * 50 + 99) / 100 - 1]);
      EXPECT_EQ(time.p99_ns, window[(count * 99 + 99) / 100 - 1]);
      EXPECT_EQ(time.max_ns, window.back());
    }
  }
}

TEST(StageTimer, IsAStageObserver) {
  StageTimer timer;
  StageObserver& observer = timer;
  timer.FrameBegins();
  observer.StageDone(Stage::kSegments);
  timer.FrameEnds();
  const StageTimes times = timer.Summary();
  ASSERT_EQ(times.size(), 2u);
  EXPECT_TRUE(times[0].stage == "segments");
  EXPECT_LE(times[0].max_ns, times[1].max_ns);
}

}  // namespace
}  // namespace wirepose::app
