#include "tools/evaluation/candidate_log.h"

#include <fmt/format.h>

#include "tools/evaluation/evidence_terms.h"
#include "tools/evaluation/vertex_error.h"

namespace wirepose::evaluation {

CandidateLog::CandidateLog(const std::filesystem::path& file) : out_(file) {
  out_ << "scene_id,im_id,obj_id,error_d,visib_fract,score";
  for (const EvidenceTerm& term : NamedTerms({})) out_ << ',' << term.name;
  out_ << '\n';
}

void CandidateLog::Add(const FrameView& view) {
  for (const Candidate& candidate : view.recognizer.candidates()) {
    const PreparedModel& model = view.recognizer.prepared_model(candidate.model);
    const Pose T_raw_model = view.recognizer.T_rectified_raw().Inverse() * candidate.pose.T_camera_model;
    double error = 9, visible = 0;
    for (const dataset::TrueInstance& truth : view.entry.gt) {
      if (static_cast<std::uint32_t>(truth.obj_id) != model.view.id) continue;
      const double here = RelativeVertexError(model, T_raw_model, truth.T_camera_model);
      if (here >= error) continue;
      error = here;
      visible = truth.visib_fract;
    }
    out_ << fmt::format("{},{},{},{:.4f},{:.3f},{:.4f}", view.entry.scene_id, view.entry.im_id, model.view.id, error,
                        visible, candidate.score);
    for (const EvidenceTerm& term : NamedTerms(candidate)) out_ << fmt::format(",{:.6g}", term.value);
    out_ << '\n';
  }
}

}  // namespace wirepose::evaluation
