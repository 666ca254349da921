#include "tools/evaluation/stage_clock.h"

#include <time.h>

#include <chrono>

namespace wirepose::evaluation {
namespace {

Seconds Now() {
  timespec cpu{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &cpu);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now().time_since_epoch();
  return {wall.count(), static_cast<double>(cpu.tv_sec) + 1e-9 * static_cast<double>(cpu.tv_nsec)};
}

Seconds operator-(const Seconds& a, const Seconds& b) { return {a.wall - b.wall, a.cpu - b.cpu}; }

}  // namespace

void StageClock::Start() {
  times_ = {};
  start_ = last_ = Now();
}

FrameTimes StageClock::Stop() {
  times_.total = Now() - start_;
  return times_;
}

void StageClock::Skip() {
  const Seconds now = Now();
  start_.wall += now.wall - last_.wall;
  start_.cpu += now.cpu - last_.cpu;
  last_ = now;
}

void StageClock::DoStageDone(Stage stage) {
  const Seconds now = Now();
  Seconds& slot = times_.stages[static_cast<std::size_t>(stage)];
  slot.wall += now.wall - last_.wall;
  slot.cpu += now.cpu - last_.cpu;
  last_ = now;
}

}  // namespace wirepose::evaluation
