// Where the time goes: how long each stage took in the last frames. The core reads no clock; this
// does.
#ifndef WIREPOSE_APP_STAGE_TIMER_H_
#define WIREPOSE_APP_STAGE_TIMER_H_

#include <array>
#include <chrono>
#include <cstdint>

#include "pipeline/recognizer.h"
#include "publish/reports.h"

namespace wirepose::app {

// Call FrameBegins, hand it to Recognizer::Process, call FrameEnds. Memory is fixed. Not thread
// safe.
class StageTimer final : public StageObserver {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kWindow = 256;  // frames: 8 s at 30 per second

  void FrameBegins(Clock::time_point now = Clock::now());
  void FrameEnds(Clock::time_point now = Clock::now());
  // For tests: what Process calls, with a time given.
  void StageDoneAt(Stage stage, Clock::time_point now);

  // Median, 99th percentile (nearest rank) and maximum over the last kWindow frames, one entry for
  // each stage that ran in them, the whole frame last. O(kWindow) a stage.
  [[nodiscard]] StageTimes Summary() const;

 private:
  static constexpr std::size_t kFrame = kStageCount;          // index of the whole frame
  using Sample = std::array<std::uint32_t, kStageCount + 1>;  // ns + 1, 0: did not run

  void DoStageDone(Stage stage) override { StageDoneAt(stage, Clock::now()); }

  std::array<Sample, kWindow> samples_{};
  std::size_t next_ = 0;   // where the frame under way is written
  std::size_t count_ = 0;  // frames in the window
  Clock::time_point frame_begin_, stage_begin_;
};

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_STAGE_TIMER_H_
