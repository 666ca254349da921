// Objects over frames: stable ids, the probability that each exists, and where it will be in the next frame.
#ifndef WIREPOSE_PIPELINE_TRACKER_H_
#define WIREPOSE_PIPELINE_TRACKER_H_

#include <chrono>
#include <cstdint>
#include <span>

#include "base/time.h"
#include "pipeline/assignment.h"
#include "pipeline/recognizer.h"
#include "pipeline/track_motion.h"

namespace wirepose {

struct TrackerParams {
  MotionParams motion;
  double gate = 40;           // squared Mahalanobis distance up to which a detection fits; beyond 22.5 lies 0.1 %
  double place_share = 0.25;  // of the diameter: nearer to the prediction it is the same object, turned
  // Share of a frame's evidence that counts: frames of one scene repeat each other's errors.
  float evidence_share = 0.3F;
  float max_existence = 0.999F, min_existence = 0.1F;  // the belief's limit, and below it the track ends
  float prior_existence = 0.3F;                        // of tracks whose prediction is looked for
  float first_rate = 0.7F;                             // how often a visible object is found, before it was observed
  float keep_mode_odds = 9;  // for the mode that the track had: others must be more probable by this factor
  std::chrono::nanoseconds end_after = std::chrono::seconds(3);             // without detection
  std::chrono::nanoseconds max_step_back = std::chrono::milliseconds(500);  // a frame that is this late is only late
};

struct Track {
  std::uint32_t id = 0;  // never 0
  std::uint32_t model_id = 0, model_checksum = 0;
  MovingPose motion;              // raw left camera, at the time of the last frame
  float log_odds = 0;             // of its existence
  float found = 0, expected = 0;  // frames it was found in, and frames it should have been found in
  CaptureTime last_seen{};
  bool seen_now = false;          // in the last frame
  std::uint8_t contradicted = 0;  // detections in a row that lay at the place but were turned

  [[nodiscard]] float existence() const;
};

struct TrackerStatistics {
  std::uint32_t started = 0, ended = 0;
  std::uint32_t dropped = 0;   // given up, or never begun, because the table was full
  std::uint32_t turned = 0;    // frames contradicted a track's orientation until it gave way
  std::uint32_t late = 0;      // frames older than their predecessor: labelled, but nothing is learned from them
  std::uint32_t restarts = 0;  // steps of the capture clock, after which all is forgotten
};

// What a frame was searched for, and with which camera. Refers to what it was made from.
struct TrackingScene {
  std::span<const PreparedModel> models;
  std::uint32_t searched = 0;  // bit m: models[m]
  RectifiedCamera camera;
  Pose T_rectified_raw;
  ImageRegion region;
};
TrackingScene SceneOf(const Recognizer& recognizer);

using PosePriors = FixedVector<PosePrior, kMaxPriors>;

// Fixed memory, no clock: times come with the frames. Not thread safe; call Predict and Update alternately. Same calls,
// same bytes.
class Tracker {
 public:
  explicit Tracker(const TrackerParams& params = {}) : params_(params) {}

  // Where the tracks will be at `time`, the most certain first: of those that probably exist, in front of the camera
  // and of models that are searched for. Nothing for a frame that comes late. O(tracks^2).
  void Predict(CaptureTime time, const TrackingScene& scene, PosePriors& priors) const;

  // Joins the detections with the tracks: sets track_id and existence, chooses of poses that a symmetry makes equal
  // the one nearest to the track's last, and of modes the one that the track had unless another is much more probable
  // (T_camera_model is then that mode). Score and covariance stay the frame's own. Detections of no track begin one.
  // Tracks that were expected to be seen and were not lose probability; they are not reported. A step of the time back
  // by more than max_step_back, or forward by more than end_after, forgets all tracks. Tracks of models that are gone
  // or changed end; those of models that are not searched for wait, until end_after.
  // O(detections * tracks * symmetries * modes).
  void Update(CaptureTime time, const TrackingScene& scene, RecognitionResult& result);

  // Ids go on: no id comes twice.
  void Forget();

  [[nodiscard]] std::span<const Track> tracks() const { return {tracks_.begin(), tracks_.end()}; }
  [[nodiscard]] const TrackerStatistics& statistics() const { return statistics_; }

 private:
  enum class Order : std::uint8_t { kFirst, kNext, kLate, kJump };
  [[nodiscard]] Order OrderOf(CaptureTime time) const;
  void AdvanceTo(CaptureTime time, const TrackingScene& scene);
  void Score(const TrackingScene& scene, const RecognitionResult& result, MatchCosts& costs) const;
  [[nodiscard]] double MatchCost(const Track& track, const PreparedModel& model, const Detection& detection) const;
  void Label(const Track& track, const PreparedModel& model, Detection& detection) const;
  void Learn(CaptureTime time, const Detection& detection, Track& track);
  void Miss(const TrackingScene& scene);
  void Begin(CaptureTime time, const PreparedModel& model, Detection& detection);
  void End(std::size_t t);

  TrackerParams params_;
  FixedVector<Track, kMaxTracks> tracks_;
  TrackerStatistics statistics_;
  CaptureTime now_{};
  bool any_frame_ = false;
  std::uint32_t last_id_ = 0;
};

// One frame with the tracks' help: predictions, recognition, update. On error the tracks stay as they are. With no
// tracker it is Recognizer::Process.
RecognizerError ProcessTracked(Recognizer& recognizer, Tracker* tracker, CaptureTime time, ImageView left,
                               ImageView right, StageObserver* observer, RecognitionResult& result);

}  // namespace wirepose

#endif  // WIREPOSE_PIPELINE_TRACKER_H_
