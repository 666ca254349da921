#include "tools/evaluation/candidate_log.h"

#include <algorithm>

#include <fmt/format.h>

namespace wirepose::evaluation {
namespace {

// Largest vertex distance, for the symmetry that makes it smallest, in diameters.
double RelativeError(const PreparedModel& model, const Pose& found, const Pose& truth) {
  double best = 9;
  for (const Pose& symmetry : model.symmetries) {
    const Pose T = truth * symmetry;
    double worst = 0;
    for (std::size_t v = 0; v < model.view.vertices.size(); ++v) {
      const Vector3d p = model.view.VertexPosition(v).cast<double>();
      worst = std::max(worst, (found * p - T * p).norm());
    }
    best = std::min(best, worst / static_cast<double>(model.view.diameter_m));
  }
  return best;
}

}  // namespace

CandidateLog::CandidateLog(const std::filesystem::path& file) : out_(file) {
  out_ << "scene_id,im_id,obj_id,error_d,visib_fract,score,edges,contrast,faces,overrun,support,inside,visible_px,"
          "supported_edges,supported_faces,rms_px,inliers\n";
}

void CandidateLog::Add(const FrameView& view) {
  for (const Candidate& candidate : view.recognizer.candidates()) {
    const PreparedModel& model = view.recognizer.prepared_model(candidate.model);
    const Pose T_raw_model = view.recognizer.T_rectified_raw().Inverse() * candidate.pose.T_camera_model;
    double error = 9, visible = 0;
    for (const dataset::TrueInstance& truth : view.entry.gt) {
      if (static_cast<std::uint32_t>(truth.obj_id) != model.view.id) continue;
      const double here = RelativeError(model, T_raw_model, truth.T_camera_model);
      if (here >= error) continue;
      error = here;
      visible = truth.visib_fract;
    }
    const Evidence& e = candidate.evidence;
    out_ << fmt::format("{},{},{},{:.4f},{:.3f},{:.4f},{:.3f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.1f},{},{},{:.4f},{}\n",
                        view.entry.scene_id, view.entry.im_id, model.view.id, error, visible, candidate.score, e.edges, e.contrast,
                        e.faces, e.overrun, e.support, e.inside, e.visible_px, e.supported_edges, e.supported_faces,
                        candidate.pose.rms_px, candidate.pose.inliers);
  }
}

}  // namespace wirepose::evaluation
