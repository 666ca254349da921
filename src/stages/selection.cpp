#include "stages/selection.h"

#include <algorithm>

namespace wirepose {
namespace {

// Visits the claim block under every edge sample that finds an image edge.
template <typename Claims, typename Visit>
void ForEachSupported(const EdgeMap& left, const EdgeSamples& samples, Claims& claims, const Visit& visit) {
  for (const EdgeSample& s : samples) {
    if (!left.Contains(s.left.x(), s.left.y())) continue;
    if (!left.HasEdge(s.left.x(), s.left.y(), EdgeMap::Direction(s.tangent.x(), s.tangent.y()))) continue;
    const int x = static_cast<int>(s.left.x()) / ClaimMap::kBlock;
    const int y = static_cast<int>(s.left.y()) / ClaimMap::kBlock;
    visit(claims.claimed[static_cast<std::size_t>(y * ClaimMap::kWidth + x)], s.weight_px);
  }
}

bool IsDuplicate(const PreparedModel& model, const Pose& p, const Pose& q) {
  return IsSamePose(model, p.R.cast<float>(), p.t.cast<float>(), q.R.cast<float>(), q.t.cast<float>(),
                    0.3F * model.view.diameter_m);
}

// Length of the supporting edges, and how much of it is claimed.
struct Length {
  float total = 0, claimed = 0;
};
Length Measure(const EdgeMap& left, const EdgeSamples& samples, const ClaimMap& claims) {
  Length length;
  ForEachSupported(left, samples, claims, [&](bool claimed, float piece) {
    length.total += piece;
    if (claimed) length.claimed += piece;
  });
  return length;
}

}  // namespace

void ClaimEdges(const RectifiedCamera& camera, const EdgeMap& left, const PreparedModel& model, const Pose& pose,
                VerifyScratch& scratch, ClaimMap& claims) {
  SampleVisibleEdges({}, camera, model, pose, scratch.front, scratch.samples);
  ForEachSupported(left, scratch.samples, claims, [](bool& claimed, float) { claimed = true; });
}

float ClaimedShare(const RectifiedCamera& camera, const EdgeMap& left, const PreparedModel& model, const Pose& pose,
                   VerifyScratch& scratch, const ClaimMap& claims) {
  SampleVisibleEdges({}, camera, model, pose, scratch.front, scratch.samples);
  const Length length = Measure(left, scratch.samples, claims);
  return length.total > 0 ? length.claimed / length.total : 0;
}

void SelectDetections(const SelectParams& params, const RectifiedCamera& camera, const EdgeMap& left,
                      std::span<const PreparedModel> models, std::span<const Candidate> candidates,
                      VerifyScratch& scratch, ClaimMap& claims, FixedVector<std::uint16_t, kMaxDetections>& accepted,
                      std::uint32_t& dropped) {
  accepted.clear();
  dropped = 0;
  claims.claimed.fill(false);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    if (c.score < params.min_score) break;
    bool duplicate = false;
    for (const std::uint16_t k : accepted) {
      const Candidate& a = candidates[k];
      duplicate = duplicate ||
                  (a.model == c.model && IsDuplicate(models[c.model], a.pose.T_camera_model, c.pose.T_camera_model));
    }
    if (duplicate) continue;
    SampleVisibleEdges({}, camera, models[c.model], c.pose.T_camera_model, scratch.front, scratch.samples);
    const Length length = Measure(left, scratch.samples, claims);
    if (length.claimed > params.max_claimed * length.total) continue;
    if (!accepted.try_push_back(static_cast<std::uint16_t>(i))) {
      ++dropped;
      continue;
    }
    ForEachSupported(left, scratch.samples, claims, [](bool& claimed, float) { claimed = true; });
  }
}

}  // namespace wirepose
