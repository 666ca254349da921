#include "pipeline/tracker.h"

#include <algorithm>
#include <cmath>

#include "base/portable_math.h"
#include "model/symmetry.h"
#include "pipeline/track_visibility.h"

namespace wirepose {
namespace {

float LogOdds(float p) { return Log(p / (1 - p)); }

double Seconds(std::chrono::nanoseconds t) { return 1e-9 * static_cast<double>(t.count()); }

// Index of the model, or models.size() when it is gone or its file is another one now.
std::size_t ModelOf(const Track& track, const TrackingScene& scene) {
  std::size_t m = 0;
  while (m < scene.models.size() &&
         (scene.models[m].view.id != track.model_id || scene.models[m].view.checksum != track.model_checksum)) {
    ++m;
  }
  return m;
}

const PreparedModel* FindModel(std::uint32_t id, const TrackingScene& scene) {
  const auto* const found = std::find_if(scene.models.data(), scene.models.data() + scene.models.size(),
                                         [id](const PreparedModel& model) { return model.view.id == id; });
  return found == scene.models.data() + scene.models.size() ? nullptr : found;
}

bool IsSearched(const TrackingScene& scene, std::size_t m) { return ((scene.searched >> m) & 1U) != 0; }

Pose NearestPose(const PreparedModel& model, const Pose& T, const Pose& reference) {
  const std::size_t s = NearestSymmetry(model, T.R, reference.R);
  return s == 0 ? T : T * model.symmetries[s];
}

// Takes another pose for the same detection: its covariance is about that pose's origin.
void SetPose(const Pose& T, Detection& detection) {
  detection.covariance = MovedCovariance(detection.covariance, T.t - detection.T_camera_model.t);
  detection.T_camera_model = T;
}

// Cost of a detection that lies at the place but is turned, up to twice that at the margin: dearer than any that fits,
// cheaper than none, and two of them dearer than one that fits and one unmatched: a false alarm beside an object does
// not push the object to another track.
constexpr double kTurnedCost = 110;
static_assert(2 * kTurnedCost <= MatchCosts::kUnmatched);

// One false alarm at the place of an object that is missed does not turn its track; so many in a row do.
constexpr std::uint8_t kContradictions = 3;

}  // namespace

float Track::existence() const { return 1 / (1 + Exp(-log_odds)); }

TrackingScene SceneOf(const Recognizer& recognizer) {
  return {recognizer.prepared_models(), recognizer.searched(), recognizer.camera(), recognizer.T_rectified_raw(),
          recognizer.region()};
}

Tracker::Order Tracker::OrderOf(CaptureTime time) const {
  if (!any_frame_) return Order::kFirst;
  if (time < now_) return now_ - time <= params_.max_step_back ? Order::kLate : Order::kJump;
  return time - now_ <= params_.end_after ? Order::kNext : Order::kJump;
}

void Tracker::Forget() {
  statistics_.ended += static_cast<std::uint32_t>(tracks_.size());
  tracks_.clear();
  any_frame_ = false;
}

void Tracker::Predict(CaptureTime time, const TrackingScene& scene, PosePriors& priors) const {
  priors.clear();
  if (OrderOf(time) != Order::kNext) return;
  FixedVector<const Track*, kMaxTracks> likely;
  for (const Track& track : tracks_) {
    const std::size_t m = ModelOf(track, scene);
    if (m == scene.models.size() || !IsSearched(scene, m)) continue;
    if (track.existence() >= params_.prior_existence) likely.push_back(&track);
  }
  std::sort(likely.begin(), likely.end(), [](const Track* p, const Track* q) {
    return p->log_odds != q->log_odds ? p->log_odds > q->log_odds : p->id < q->id;
  });
  for (const Track* track : likely) {
    MovingPose motion = track->motion;
    Advance(params_.motion, Seconds(time - now_), motion);
    const PreparedModel& model = scene.models[ModelOf(*track, scene)];
    if (VisibleShare(scene, model, motion.T, {}) <= 0) continue;
    if (!priors.try_push_back({track->model_id, motion.T})) break;
  }
}

void Tracker::Update(CaptureTime time, const TrackingScene& scene, RecognitionResult& result) {
  const Order order = OrderOf(time);
  if (order == Order::kJump) {
    ++statistics_.restarts;
    Forget();
  }
  if (order == Order::kLate) ++statistics_.late;
  if (order == Order::kNext) AdvanceTo(time, scene);
  if (order != Order::kLate) {
    now_ = time;
    any_frame_ = true;
  }
  MatchCosts costs;
  Score(scene, result, costs);
  const auto track_of = AssignTracks(costs);
  for (std::size_t d = 0; d < track_of.size(); ++d) {
    Detection& detection = result.detections[d];
    const PreparedModel* const model = FindModel(detection.model_id, scene);
    if (model == nullptr || track_of[d] == kNoTrack) continue;
    Track& track = tracks_[track_of[d]];
    Label(track, *model, detection);
    if (order != Order::kLate) Learn(time, detection, track);
    detection.existence = track.existence();
  }
  if (order == Order::kLate) return;
  Miss(scene);
  for (Detection& detection : result.detections) {
    const PreparedModel* const model = FindModel(detection.model_id, scene);
    if (model != nullptr && detection.track_id == 0) Begin(time, *model, detection);
  }
}

void Tracker::AdvanceTo(CaptureTime time, const TrackingScene& scene) {
  for (std::size_t t = tracks_.size(); t-- > 0;) {
    Track& track = tracks_[t];
    if (ModelOf(track, scene) == scene.models.size() || time - track.last_seen > params_.end_after) {
      End(t);
      continue;
    }
    Advance(params_.motion, Seconds(time - now_), track.motion);
    track.seen_now = false;
  }
}

void Tracker::Score(const TrackingScene& scene, const RecognitionResult& result, MatchCosts& costs) const {
  costs.detections = result.detections.size();
  costs.tracks = tracks_.size();
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const std::size_t m = ModelOf(tracks_[t], scene);
    for (std::size_t d = 0; d < costs.detections; ++d) {
      const Detection& detection = result.detections[d];
      const bool same = m < scene.models.size() && detection.model_id == tracks_[t].model_id;
      costs.cost[d][t] = same ? MatchCost(tracks_[t], scene.models[m], detection) : MatchCosts::kNoMatch;
    }
  }
}

double Tracker::MatchCost(const Track& track, const PreparedModel& model, const Detection& detection) const {
  const Pose& predicted = track.motion.T;
  double cost = MatchCosts::kNoMatch;
  const auto consider = [&](const Pose& T) {
    const Pose nearest = NearestPose(model, T, predicted);
    const Fit fit =
        FitOf(track.motion, nearest, MovedCovariance(detection.covariance, nearest.t - detection.T_camera_model.t));
    if (fit.distance2 <= params_.gate) cost = std::min(cost, fit.cost);
  };
  consider(detection.T_camera_model);
  for (const PoseMode& mode : detection.modes) consider(mode.T_camera_model);
  if (cost < MatchCosts::kNoMatch) return cost;
  const Vector3d centre = model.centre.cast<double>();
  const double distance = (detection.T_camera_model * centre - predicted * centre).norm();
  const double reach = params_.place_share * static_cast<double>(model.view.diameter_m);
  return distance <= reach ? kTurnedCost * (1 + distance / reach) : MatchCosts::kNoMatch;
}

void Tracker::Label(const Track& track, const PreparedModel& model, Detection& detection) const {
  detection.track_id = track.id;
  const Pose& predicted = track.motion.T;
  if (detection.modes.empty()) {
    const std::size_t s = NearestSymmetry(model, detection.T_camera_model.R, predicted.R);
    if (s != 0) SetPose(detection.T_camera_model * model.symmetries[s], detection);
    return;
  }
  PoseMode* kept = nullptr;
  double least = params_.gate;
  for (PoseMode& mode : detection.modes) {
    mode.T_camera_model = NearestPose(model, mode.T_camera_model, predicted);
    const Matrix6d covariance =
        MovedCovariance(detection.covariance, mode.T_camera_model.t - detection.T_camera_model.t);
    const double distance2 = FitOf(track.motion, mode.T_camera_model, covariance).distance2;
    if (distance2 > least) continue;
    least = distance2;
    kept = &mode;
  }
  if (kept != nullptr) kept->weight *= params_.keep_mode_odds;
  float total = 0;
  for (const PoseMode& mode : detection.modes) total += mode.weight;
  for (PoseMode& mode : detection.modes) mode.weight /= total;
  std::sort(detection.modes.begin(), detection.modes.end(), [](const PoseMode& p, const PoseMode& q) {
    return p.weight != q.weight ? p.weight > q.weight : p.T_camera_model.t.x() < q.T_camera_model.t.x();
  });
  SetPose(detection.modes[0].T_camera_model, detection);
}

void Tracker::Learn(CaptureTime time, const Detection& detection, Track& track) {
  const bool fits = FitOf(track.motion, detection.T_camera_model, detection.covariance).distance2 <= params_.gate;
  if (fits) {
    Correct(detection.T_camera_model, detection.covariance, track.motion);
    track.contradicted = 0;
  } else if (++track.contradicted >= kContradictions) {
    // The frames know better. Where to and how fast it goes is still known.
    const Vector6d velocity = track.motion.velocity;
    track.motion = StartMotion(params_.motion, detection.T_camera_model, detection.covariance);
    track.motion.velocity.tail<3>() = velocity.tail<3>();
    track.contradicted = 0;
    ++statistics_.turned;
  }
  const float limit = LogOdds(params_.max_existence);
  const float gain = LogOdds(std::clamp(detection.score, 0.02F, 0.98F));
  track.log_odds = std::clamp(track.log_odds + params_.evidence_share * gain, -limit, limit);
  track.found += 1;
  track.expected += 1;
  track.last_seen = time;
  track.seen_now = true;
}

// An object that exists is missed with probability 1 - rate * visible, one that does not always.
void Tracker::Miss(const TrackingScene& scene) {
  FixedVector<Occluder, kMaxTracks> occluders;
  for (const Track& track : tracks_) {
    const std::size_t m = ModelOf(track, scene);
    Occluder occluder;
    if (track.seen_now && m < scene.models.size() && OccluderAt(scene, scene.models[m], track.motion.T, occluder)) {
      occluders.push_back(occluder);
    }
  }
  for (std::size_t t = tracks_.size(); t-- > 0;) {
    Track& track = tracks_[t];
    const std::size_t m = ModelOf(track, scene);
    if (track.seen_now || m == scene.models.size() || !IsSearched(scene, m)) continue;
    const float visible = VisibleShare(scene, scene.models[m], track.motion.T, {occluders.begin(), occluders.end()});
    constexpr float kPriorFrames = 4;
    const float rate = (track.found + kPriorFrames * params_.first_rate) / (track.expected + kPriorFrames);
    track.log_odds += params_.evidence_share * Log(1 - std::min(0.95F, rate * visible));
    track.expected += visible;
    if (track.existence() < params_.min_existence) End(t);
  }
  // Rates follow what changes: some sixty frames count.
  for (Track& track : tracks_) {
    if (track.expected < 64) continue;
    track.found *= 0.5F;
    track.expected *= 0.5F;
  }
}

void Tracker::Begin(CaptureTime time, const PreparedModel& model, Detection& detection) {
  Track track;
  track.model_id = model.view.id;
  track.model_checksum = model.view.checksum;
  track.motion = StartMotion(params_.motion, detection.T_camera_model, detection.covariance);
  track.log_odds = LogOdds(std::clamp(detection.score, 0.02F, 0.98F));
  track.found = track.expected = 1;
  track.last_seen = time;
  track.seen_now = true;
  if (tracks_.full()) {
    std::size_t least = 0;
    for (std::size_t t = 1; t < tracks_.size(); ++t) {
      if (tracks_[t].log_odds < tracks_[least].log_odds) least = t;
    }
    ++statistics_.dropped;
    if (tracks_[least].log_odds >= track.log_odds) return;
    End(least);
  }
  if (++last_id_ == 0) ++last_id_;
  track.id = last_id_;
  detection.track_id = track.id;
  detection.existence = track.existence();
  tracks_.push_back(track);
  ++statistics_.started;
}

void Tracker::End(std::size_t t) {
  tracks_[t] = tracks_.back();
  tracks_.pop_back();
  ++statistics_.ended;
}

RecognizerError ProcessTracked(Recognizer& recognizer, Tracker* tracker, CaptureTime time, ImageView left,
                               ImageView right, StageObserver* observer, RecognitionResult& result) {
  if (tracker == nullptr) return recognizer.Process(left, right, observer, result);
  PosePriors priors;
  tracker->Predict(time, SceneOf(recognizer), priors);
  const RecognizerError error = recognizer.Process(left, right, {priors.begin(), priors.end()}, observer, result);
  if (error == RecognizerError::kOk) tracker->Update(time, SceneOf(recognizer), result);
  return error;
}

}  // namespace wirepose
