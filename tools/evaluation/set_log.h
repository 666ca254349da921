// Every promoted line set with its evidence: what the rank of sets is fitted to.
#ifndef WIREPOSE_TOOLS_EVALUATION_SET_LOG_H_
#define WIREPOSE_TOOLS_EVALUATION_SET_LOG_H_

#include <filesystem>
#include <fstream>

#include "hal/dataset/dataset.h"
#include "tools/evaluation/stage_clock.h"

namespace wirepose::evaluation {

// Writes one CSV row a set: scene_id, im_id, obj_id, error_d of the aligned pose as in candidate_log.h, and the terms
// of SetEvidence. Observes Process on the caller's thread and passes every call on to `next`; `clock` does not time the
// writing. Holds references. A file that cannot be written leaves ok() false.
class SetLog final : public StageObserver {
 public:
  SetLog(const std::filesystem::path& file, const Recognizer& recognizer, StageObserver& next, StageClock& clock);

  // Before Process.
  void Start(const dataset::FrameEntry& frame);
  [[nodiscard]] bool ok() const { return out_.good(); }

 private:
  void DoStageDone(Stage stage) override;
  void Write(const PreparedModel& model);

  std::ofstream out_;
  const Recognizer& recognizer_;
  StageObserver& next_;
  StageClock& clock_;
  const dataset::FrameEntry* frame_ = nullptr;
  std::size_t models_seen_ = 0;
};

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_SET_LOG_H_
