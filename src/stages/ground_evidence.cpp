#include "stages/ground_evidence.h"

#include <algorithm>
#include <cmath>

namespace wirepose {
namespace {

constexpr int kPointsAlongEdge = 6;

struct Votes {
  float in = 0, nearer = 0, farther = 0;
  float offset = 0;  // sum over `in`, in tolerances
};

class Looker {
 public:
  Looker(const GroundEvidenceParams& params, const RectifiedCamera& camera, const DisparityMap& scene,
         const PreparedModel& model, const Pose& T, const SurfaceMap& surface)
      : params_(params),
        camera_(camera),
        scene_(scene),
        model_(model),
        surface_(surface),
        R_(T.R.cast<float>()),
        t_(T.t.cast<float>()),
        eye_(-(R_.transpose() * t_)) {}

  // The face that the scene agrees with best.
  [[nodiscard]] GroundEvidence Best() const {
    GroundEvidence best;
    for (const PreparedFoot& foot : model_.feet) {
      if (IsTowards(model_.view.faces[foot.face], eye_)) continue;
      const GroundEvidence here = Judge(Around(foot));
      if (here.stands > best.stands || (here.stands == best.stands && here.hangs > best.hangs)) best = here;
    }
    return best;
  }

 private:
  [[nodiscard]] Votes Around(const PreparedFoot& foot) const {
    Votes votes;
    const ModelFace& face = model_.view.faces[foot.face];
    const Vector3 normal(face.normal[0], face.normal[1], face.normal[2]);
    for (std::size_t e = 0; e < model_.edges.size(); ++e) {
      const auto& faces = model_.view.edges[e].face;
      if (faces[0] == foot.face || faces[1] == foot.face) AlongEdge(foot, normal, model_.edges[e], votes);
    }
    return votes;
  }

  void AlongEdge(const PreparedFoot& foot, const Vector3& normal, const PreparedEdge& edge, Votes& votes) const {
    Vector3 outward = edge.direction.cross(normal);
    if (outward.dot(0.5F * (edge.a + edge.b) - foot.centre) < 0) outward = -outward;
    for (int k = 0; k < kPointsAlongEdge; ++k) {
      const float s = (static_cast<float>(k) + 0.5F) / kPointsAlongEdge;
      const Vector3 at = edge.a + s * (edge.b - edge.a);
      const float metres_per_px = (R_ * at + t_).z() / static_cast<float>(camera_.f);
      for (const float beside : params_.beside_px) Look(R_ * (at + beside * metres_per_px * outward) + t_, votes);
    }
  }

  // Compares the scene's disparity with that of a point in the camera frame.
  void Look(const Vector3& p, Votes& votes) const {
    if (p.z() < kMinDepthM) return;
    const float scale = static_cast<float>(camera_.f) / p.z();
    const float x = scale * p.x() + static_cast<float>(camera_.cx), y = scale * p.y() + static_cast<float>(camera_.cy);
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(camera_.width) && y < static_cast<float>(camera_.height))) return;
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const float seen = scene_.At(i, j);
    if (seen <= 0 || surface_.AtPixel(i, j) > 0) return;
    const float expected = static_cast<float>(camera_.baseline) * scale;
    const float tolerance = std::max(params_.tolerance_px, params_.tolerance_share * expected);
    if (std::abs(seen - expected) > tolerance) {
      (seen > expected ? votes.nearer : votes.farther) += 1;
      return;
    }
    votes.in += 1;
    votes.offset += (seen - expected) / tolerance;
  }

  [[nodiscard]] GroundEvidence Judge(const Votes& v) const {
    const float open = v.in + v.farther + params_.prior_votes;
    // With nothing known the mean is as far off as a uniform distribution's magnitude.
    const float gap = (std::abs(v.offset) + 0.5F * params_.prior_votes) / (v.in + params_.prior_votes);
    return {v.in / open, v.farther / open, v.nearer / (open + v.nearer), gap};
  }

  static constexpr float kMinDepthM = 0.05F;

  const GroundEvidenceParams& params_;
  const RectifiedCamera& camera_;
  const DisparityMap& scene_;
  const PreparedModel& model_;
  const SurfaceMap& surface_;
  Matrix3 R_;
  Vector3 t_, eye_;
};

}  // namespace

void GatherGroundEvidence(const GroundEvidenceParams& params, const RectifiedCamera& camera, const DisparityMap& scene,
                          const PreparedModel& model, const Pose& T_camera_model, const SurfaceMap& surface,
                          GroundEvidence& out) {
  out = Looker(params, camera, scene, model, T_camera_model, surface).Best();
}

}  // namespace wirepose
