#include "tools/evaluation/set_log.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/evaluation/vertex_error.h"

namespace wirepose::evaluation {

SetLog::SetLog(const std::filesystem::path& file, const Recognizer& recognizer, StageObserver& next, StageClock& clock)
    : out_(file), recognizer_(recognizer), next_(next), clock_(clock) {
  out_ << "scene_id,im_id,obj_id,error_d";
  for (const char* name : SetTermNames()) out_ << ',' << name;
  out_ << '\n';
}

void SetLog::Start(const dataset::FrameEntry& frame) {
  frame_ = &frame;
  models_seen_ = 0;
}

void SetLog::DoStageDone(Stage stage) {
  next_.StageDone(stage);
  if (stage == Stage::kHypotheses) Write(recognizer_.prepared_model(models_seen_++));
  clock_.Skip();
}

void SetLog::Write(const PreparedModel& model) {
  for (const CorrespondingSet& set : recognizer_.sets()) {
    const Pose T = recognizer_.T_rectified_raw().Inverse() * Pose{set.R.cast<double>(), set.t.cast<double>()};
    double error = 9;
    for (const dataset::TrueInstance& truth : frame_->gt) {
      if (static_cast<std::uint32_t>(truth.obj_id) != model.view.id) continue;
      error = std::min(error, RelativeVertexError(model, T, truth.T_camera_model));
    }
    out_ << fmt::format("{},{},{},{:.4f}", frame_->scene_id, frame_->im_id, model.view.id, error);
    for (const float term : TermsOf(set.evidence)) out_ << fmt::format(",{:.6g}", term);
    out_ << '\n';
  }
}

}  // namespace wirepose::evaluation
