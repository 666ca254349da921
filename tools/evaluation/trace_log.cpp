#include "tools/evaluation/trace_log.h"

#include <fmt/format.h>

namespace wirepose::evaluation {

TraceLog::TraceLog(const std::filesystem::path& file) : out_(file) {
  out_ << "scene_id,im_id,obj_id,visib_fract,depth_m,visible_edges,found_edges,deep_edges,hypothesis_error_d,"
          "hypothesis_rank,set_error_d,set_rank,candidate_error_d,candidate_rank,candidate_score,cause\n";
}

void TraceLog::Add(const FrameView& view) {
  for (const InstanceTrace& t : view.traces) {
    if (view.models.Find(static_cast<std::uint32_t>(t.object_id)) == nullptr) continue;
    out_ << fmt::format("{},{},{},{:.3f},{:.3f},{},{},{},{:.3f},{},{:.3f},{},{:.3f},{},{:.4f},{}\n",
                        view.entry.scene_id, view.entry.im_id, t.object_id, t.visible_fraction, t.depth_m,
                        t.visible_edges, t.found_edges, t.deep_edges, t.hypothesis.error_d, t.hypothesis.rank,
                        t.set.error_d, t.set.rank, t.candidate.error_d, t.candidate.rank, t.candidate.score,
                        CauseName(CauseOf(t)));
  }
}

}  // namespace wirepose::evaluation
