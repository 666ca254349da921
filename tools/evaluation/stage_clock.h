// Times the recognizer's stages from outside: the core reads no clock.
#ifndef WIREPOSE_TOOLS_EVALUATION_STAGE_CLOCK_H_
#define WIREPOSE_TOOLS_EVALUATION_STAGE_CLOCK_H_

#include <array>

#include "pipeline/recognizer.h"

namespace wirepose::evaluation {

// Two clocks at once: wall time is what the robot waits, CPU time is what the work costs on a busy
// machine.
struct Seconds {
  double wall = 0;
  double cpu = 0;  // of the calling thread
};

struct FrameTimes {
  std::array<Seconds, kStageCount> stages;
  Seconds total;
};

// Start() before Process, Stop() after it; the stages report in between. A stage that did not run
// has no time.
class StageClock final : public StageObserver {
 public:
  void Start();
  FrameTimes Stop();
  // The time since the last stage was not the recognizer's: an observer's. It counts neither as the next stage's nor in
  // the total.
  void Skip();

 private:
  void DoStageDone(Stage stage) override;

  Seconds start_;
  Seconds last_;
  FrameTimes times_;
};

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_STAGE_CLOCK_H_
