// From judged candidates to detections: one canonical pose each, and the poses that the evidence cannot tell from it.
#include <algorithm>

#include "model/symmetry.h"
#include "pipeline/recognizer.h"
#include "pipeline/track_motion.h"

namespace wirepose {
namespace {

float OddsOf(float score) { return score / std::max(1 - score, 1e-4F); }

bool AreNear(const PreparedModel& model, const Pose& p, const Pose& q, float tolerance_m) {
  return IsSamePose(model, p.R.cast<float>(), p.t.cast<float>(), q.R.cast<float>(), q.t.cast<float>(), tolerance_m);
}

double CentreDistance(const PreparedModel& model, const Pose& p, const Pose& q) {
  const Vector3d centre = model.centre.cast<double>();
  return (p * centre - q * centre).norm();
}

}  // namespace

void Recognizer::SetPriors(std::span<const PosePrior> priors) {
  priors_.clear();
  for (const PosePrior& prior : priors) {
    if (!priors_.try_push_back({prior.model_id, T_rectified_raw() * prior.T_camera_model})) break;
  }
}

// The orientation that decides between poses which a symmetry makes equal: that of the prior at this place, if any.
Matrix3d Recognizer::ReferenceFor(const Candidate& candidate) const {
  const PreparedModel& model = models_[candidate.model];
  double nearest = 0.3 * static_cast<double>(model.view.diameter_m);
  Matrix3d R = T_rectified_raw().R * CanonicalOrientation();
  for (const PosePrior& prior : priors_) {
    if (prior.model_id != model.view.id) continue;
    const double distance = CentreDistance(model, prior.T_camera_model, candidate.pose.T_camera_model);
    if (distance >= nearest) continue;
    nearest = distance;
    R = prior.T_camera_model.R;
  }
  return R;
}

void Recognizer::MakeCanonical(const Matrix3d& R_reference, Candidate& candidate) const {
  const PreparedModel& model = models_[candidate.model];
  Pose& T = candidate.pose.T_camera_model;
  const std::size_t s = NearestSymmetry(model, T.R, R_reference);
  if (s == 0) return;
  const Pose& symmetry = model.symmetries[s];
  const Pose turned = T * symmetry;
  candidate.pose.covariance = MovedCovariance(candidate.pose.covariance, turned.t - T.t);
  T = turned;
  for (SetMember& member : candidate.members) {
    member.edge = static_cast<std::uint16_t>(EdgeBeforeSymmetry(model, symmetry, member.edge));
  }
}

// True when the candidate is about as probable, lies elsewhere, and stands on the edges that claims_ marks.
bool Recognizer::IsRival(const Candidate& candidate, const Rivals& rivals, float min_odds) {
  if (OddsOf(candidate.score) < min_odds) return false;
  const PreparedModel& model = models_[candidate.model];
  const Pose& T = candidate.pose.T_camera_model;
  if (CentreDistance(model, rivals[0].T_camera_model, T) > static_cast<double>(model.view.diameter_m)) return false;
  const float tolerance = params_.ambiguity.distinct_share * model.view.diameter_m;
  for (const Rival& rival : rivals) {
    if (AreNear(model, rival.T_camera_model, T, tolerance)) return false;
  }
  return ClaimedShare(camera(), left_edges_, model, T, verify_scratch_, claims_) >= params_.ambiguity.min_overlap;
}

// Candidates come from lines, and few of them; a pose turned by a near symmetry is tried for its own sake.
void Recognizer::FindTurnedRivals(const Candidate& candidate, float min_odds, Rivals& rivals) {
  const PreparedModel& model = models_[candidate.model];
  const NearTurns& near_turns = near_turns_[candidate.model];
  if (near_turns.empty()) return;
  const SceneEdges scene = Edges();
  const PoseScorer scorer(params_.hypotheses.score, scene, model);
  const auto support = [&](const Pose& T) {
    PoseSupport found;
    const Vector3 eye = T.Inverse().t.cast<float>();
    return scorer.Score(T.R.cast<float>(), T.t.cast<float>(), model.VisibleEdges(eye), found) ? found.score : 0;
  };
  const float needed = params_.ambiguity.turned_support * support(candidate.pose.T_camera_model);
  const float tolerance = params_.ambiguity.distinct_share * model.view.diameter_m;
  for (const std::uint8_t k : near_turns) {
    const Pose start = candidate.pose.T_camera_model * TurnedModel(model, k);
    const bool known = std::any_of(rivals.begin(), rivals.end(), [&](const Rival& rival) {
      return AreNear(model, rival.T_camera_model, start, tolerance);
    });
    if (known || !(start.t.z() > 0) || support(start) < std::max(needed, 0.01F)) continue;
    Candidate turned;
    turned.model = candidate.model;
    Adjust(model, start, turned.pose);
    if (!turned.pose.ok) continue;
    Judge(turned);
    if (IsRival(turned, rivals, min_odds)) rivals.push_back({turned.pose.T_camera_model, OddsOf(turned.score)});
  }
}

// Modes are rivals for one place: at most one of them is right, and their odds tell how probable each is.
void Recognizer::FindModes(std::size_t i, std::span<const Candidate> candidates, const Matrix3d& R_reference,
                           Detection& detection) {
  const Candidate& chosen = candidates[i];
  const PreparedModel& model = models_[chosen.model];
  Rivals rivals;
  rivals.push_back({chosen.pose.T_camera_model, OddsOf(chosen.score)});
  const float min_odds = params_.ambiguity.min_weight * rivals[0].odds;
  claims_.claimed.fill(false);
  ClaimEdges(camera(), left_edges_, model, chosen.pose.T_camera_model, verify_scratch_, claims_);
  for (std::size_t k = i + 1; k < candidates.size(); ++k) {
    const Candidate& c = candidates[k];
    if (c.model != chosen.model || std::find(accepted_.begin(), accepted_.end(), k) != accepted_.end()) continue;
    if (IsRival(c, rivals, min_odds)) rivals.push_back({c.pose.T_camera_model, OddsOf(c.score)});
  }
  FindTurnedRivals(chosen, min_odds, rivals);
  // Insertion sort: few and stable.
  for (Rival* r = rivals.begin(); r != rivals.end(); ++r) {
    Rival* const place =
        std::upper_bound(rivals.begin(), r, *r, [](const Rival& a, const Rival& b) { return a.odds > b.odds; });
    std::rotate(place, r, r + 1);
  }
  rivals.resize(std::min(rivals.size(), kMaxModes));
  const auto sum = [&] {
    float odds = 0;
    for (const Rival& rival : rivals) odds += rival.odds;
    return odds;
  };
  while (rivals.size() > 1 && rivals.back().odds < params_.ambiguity.min_weight * sum()) rivals.pop_back();
  if (rivals.size() < 2) return;
  const Pose T_raw_rectified = T_rectified_raw().Inverse();
  const float total = sum();
  for (const Rival& rival : rivals) {
    const Pose& T = rival.T_camera_model;
    const std::size_t s = NearestSymmetry(model, T.R, R_reference);
    detection.modes.push_back({T_raw_rectified * (s == 0 ? T : T * model.symmetries[s]), rival.odds / total});
  }
}

// Results are given in the raw left camera's frame.
Detection Recognizer::DetectionOf(const Candidate& candidate) const {
  const Pose T_raw_rectified = T_rectified_raw().Inverse();
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = T_raw_rectified.R;
  turn.bottomRightCorner<3, 3>() = T_raw_rectified.R;
  Detection detection;
  detection.model_id = models_[candidate.model].view.id;
  detection.T_camera_model = T_raw_rectified * candidate.pose.T_camera_model;
  detection.covariance = turn * candidate.pose.covariance * turn.transpose();
  detection.score = candidate.score;
  detection.visible_fraction =
      candidate.evidence.edges.support * candidate.evidence.edges.inside * (1 - candidate.evidence.hidden);
  return detection;
}

void Recognizer::Report(RecognitionResult& result) {
  auto& candidates = candidates_.Sorted();
  std::uint32_t dropped = 0;
  SelectDetections(params_.select, camera(), left_edges_, {models_.begin(), models_.end()},
                   {candidates.begin(), candidates.end()}, verify_scratch_, claims_, accepted_, dropped);
  for (const std::uint16_t i : accepted_) {
    Candidate& candidate = candidates[i];
    const Matrix3d R_reference = ReferenceFor(candidate);
    MakeCanonical(R_reference, candidate);
    result.detections.push_back(DetectionOf(candidate));
    FindModes(i, {candidates.begin(), candidates.end()}, R_reference, result.detections.back());
  }
  result.statistics.detections = {static_cast<std::uint32_t>(accepted_.size()),
                                  static_cast<std::uint32_t>(kMaxDetections), dropped};
}

}  // namespace wirepose
