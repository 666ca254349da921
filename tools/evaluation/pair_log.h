// Corresponding pairs and whether they are right: what their rank is fitted to.
#ifndef WIREPOSE_TOOLS_EVALUATION_PAIR_LOG_H_
#define WIREPOSE_TOOLS_EVALUATION_PAIR_LOG_H_

#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "hal/dataset/dataset.h"
#include "tools/evaluation/stage_clock.h"

namespace wirepose::evaluation {

// Writes one CSV row a pair: scene_id, im_id, obj_id, the true instance whose edges both lines show (its place in the
// frame's truth; -1: none), how many pairs the row stands for, class, and the terms of pair_rank.h. Every base line is
// matched by itself, so that hardly a pair is missing because others rank higher; of the wrong ones, one in
// kWrongPerRow is written. Instances less than 40 % visible count as absent. Observes Process on the caller's thread
// and passes every call on to `next`; `clock` does not time the writing. Holds references. A file that cannot be
// written leaves ok() false.
class PairLog final : public StageObserver {
 public:
  static constexpr int kWrongPerRow = 200;

  PairLog(const std::filesystem::path& file, const Recognizer& recognizer, StageObserver& next, StageClock& clock);

  // Before Process.
  void Start(const dataset::FrameEntry& frame);
  [[nodiscard]] bool ok() const { return out_.good(); }

 private:
  struct Truth {
    int instance = 0;
    std::vector<Pose> poses;  // T_camera_model in the rectified frame, one a symmetry
  };

  void DoStageDone(Stage stage) override;
  void WriteModel(const PreparedModel& model);
  [[nodiscard]] std::vector<Truth> TruthOf(const PreparedModel& model) const;
  [[nodiscard]] int InstanceOf(const PreparedModel& model, const std::vector<Truth>& truth,
                               const CorrespondingPair& match) const;
  void WriteRow(const PreparedModel& model, const CorrespondingPair& match, int instance);

  std::ofstream out_;
  const Recognizer& recognizer_;
  StageObserver& next_;
  StageClock& clock_;
  const dataset::FrameEntry* frame_ = nullptr;
  std::size_t models_seen_ = 0;
  std::size_t wrong_ = 0;
  Lines3 lines_;
  std::unique_ptr<ImageLineSets> sets_;  // of one base line
  std::unique_ptr<CorrespondingPairs> pairs_;
};

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_PAIR_LOG_H_
