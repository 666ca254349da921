// The recognizer: a stereo pair, or an image with its depth, in; known objects with their poses out.
#ifndef WIREPOSE_PIPELINE_RECOGNIZER_H_
#define WIREPOSE_PIPELINE_RECOGNIZER_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

#include "base/fixed_vector.h"
#include "base/image_view.h"
#include "capacities.h"
#include "geometry/camera.h"
#include "model/prepared_model.h"
#include "model/symmetry.h"
#include "pipeline/recognition.h"
#include "stages/correspondences.h"
#include "stages/depth_lines.h"
#include "stages/disparity_image.h"
#include "stages/disparity_map.h"
#include "stages/edge_image.h"
#include "stages/edge_map.h"
#include "stages/hypotheses.h"
#include "stages/line_sets.h"
#include "stages/normalize.h"
#include "stages/promotion.h"
#include "stages/rectification.h"
#include "stages/refinement.h"
#include "stages/row_offsets.h"
#include "stages/score.h"
#include "stages/segments.h"
#include "stages/selection.h"
#include "stages/stereo_lines.h"
#include "stages/verification.h"

namespace wirepose {

enum class [[nodiscard]] RecognizerError : std::uint8_t{
    kOk,
    kBadCalibration,  // a focal length or baseline that is not positive, a rotation that is none, distortion too strong
    kImageTooLarge,   // the calibration's image exceeds kMaxImageWidth x kMaxImageHeight or is smaller than 64 x 64
    kNotConfigured,   // Process before Configure
    kImageSizeMismatch,  // an image that is not of the calibrated size
    kTooManyModels,      // more than kMaxModels
    kDuplicateModel,     // two models of one id
    kOtherCamera,        // Process after Configure for a camera with depth, or ProcessDepth after one for a stereo pair
    kBadDepthUnit,       // metres a unit of depth: not in (0, 1]
};

// One line for people: what is wrong and what to do.
const char* Describe(RecognizerError error);

// Called after each stage of Process, on the caller's thread: for stage times and for looking at intermediates.
// The core reads no clock; who wants times takes them here.
class StageObserver {
 public:
  void StageDone(Stage stage) { DoStageDone(stage); }

 protected:
  ~StageObserver() = default;

 private:
  virtual void DoStageDone(Stage stage) = 0;
};

// Which poses of one object are reported as modes.
struct AmbiguityParams {
  float min_weight = 0.05F;      // lighter modes are not reported
  float min_overlap = 0.5F;      // share of a rival's supporting edges that also support the detection
  float distinct_share = 0.1F;   // of the diameter: nearer poses are one mode
  float turned_support = 0.75F;  // of the detection's coarse score: what a turned pose needs to be looked at
};

// Every parameter of every stage, with the one default that all models and all data share.
struct RecognizerParams {
  EdgeImageParams edges;
  SegmentParams segments;
  StereoLineParams stereo;
  DisparityMapParams disparity;
  RowOffsetParams row_offsets;
  DisparityImageParams depth_image;
  DepthLineParams depth_lines;
  LineSetParams line_sets;
  CorrespondenceParams correspondences;
  HypothesisParams hypotheses;
  PromotionParams promotion;
  // From where the line sets are. What fits badly may fit when all samples are looked at; if not, it is still judged.
  RefineParams refine{.iterations = 4, .samples = {.step_px = 14}, .max_rms_px = 2.0F};
  // Then with all that the images tell of the pose.
  RefineParams polish{.samples = {.step_px = 6}, .first_range_px = 6};
  VerifyParams verify;
  SelectParams select;
  AmbiguityParams ambiguity;
};

// A rectangle of the raw left image; without area it stands for the whole image.
struct ImageRegion {
  std::uint16_t x = 0, y = 0, width = 0, height = 0;  // px
  [[nodiscard]] bool Whole() const { return width == 0 || height == 0; }
  bool operator==(const ImageRegion&) const = default;
};

// Tells the observer, if any.
class StageTimer {
 public:
  explicit StageTimer(StageObserver* observer) : observer_(observer) {}
  void Done(Stage stage) {
    if (observer_ != nullptr) observer_->StageDone(stage);
  }

 private:
  StageObserver* observer_;
};

// All memory of the recognizer is part of this object: make it static. Not thread safe; no call allocates, blocks or
// reads a clock. The same calls with the same bytes give the same bytes on every target.
class Recognizer {
 public:
  // Computes the rectification. Keeps the models. Any previous calibration is replaced; on error nothing changes.
  RecognizerError Configure(const StereoCalibration& calibration, const RecognizerParams& params = {});

  // The same for one camera with registered depth. kBadCalibration and kImageTooLarge as above.
  RecognizerError Configure(const DepthCalibration& calibration, const RecognizerParams& params = {});

  // Adds an object to search for. The bytes behind the view must stay unchanged until ClearModels.
  RecognizerError AddModel(const ModelView& model);
  void ClearModels();
  [[nodiscard]] std::span<const ModelView> models() const { return {views_.begin(), views_.end()}; }

  // Restricts the following frames to the models whose bit is set, by their order of addition. AddModel sets the new
  // model's bit.
  void SearchFor(std::uint32_t model_bits) { searched_ = model_bits; }
  [[nodiscard]] std::uint32_t searched() const { return searched_; }
  // Restricts the following frames to objects that show at least one line in the region: only left segments whose
  // middle lies in it are used for matching. Evidence for and against a pose comes from the whole image as before.
  void SetRegion(const ImageRegion& region) { region_ = region; }
  [[nodiscard]] const ImageRegion& region() const { return region_; }

  // Recognizes every added model in a raw pair of the calibrated size. `observer` may be null. Bounded time: every loop
  // has a compile-time bound; a search that stops at its bound sets `budget_hit`.
  RecognizerError Process(ImageView left, ImageView right, StageObserver* observer, RecognitionResult& result) {
    return Process(left, right, {}, observer, result);
  }
  // The same with poses to start from besides those that the lines suggest. They are refined, verified and scored like
  // every other candidate: a prior finds what lines miss but makes no pose more probable. Of poses that a symmetry
  // makes equal the one nearest to a prior at the same place is reported. The first kMaxPriors are used; priors of
  // models that are not searched for are ignored.
  RecognizerError Process(ImageView left, ImageView right, std::span<const PosePrior> priors, StageObserver* observer,
                          RecognitionResult& result);

  // The same in an image with its depth: lines get theirs from the surfaces beside them instead of a second image, and
  // what a second image would say is left open. Poses are in the camera's frame.
  RecognizerError ProcessDepth(ImageView image, const DepthView& depth, StageObserver* observer,
                               RecognitionResult& result);

  // The rectified pair's camera and the rotation into it: p_rectified = T_rectified_raw * p_raw (rotation only).
  [[nodiscard]] const RectifiedCamera& camera() const { return rectification_.camera; }
  [[nodiscard]] const Pose& T_rectified_raw() const { return rectification_.T_rectified_raw; }

  // Intermediates of the last Process, for overlays and tests. Rectified left frame; valid until the next call.
  [[nodiscard]] ImageView left_rectified() const { return View(left_rectified_); }
  // Without pixels when there is no right camera; then `left` is the only one.
  [[nodiscard]] ImageView right_rectified() const {
    return camera().has_right_image ? View(right_rectified_) : ImageView{};
  }
  [[nodiscard]] const DisparityMap& disparity_map() const { return disparity_; }
  [[nodiscard]] std::span<const Segment2> left_segments() const {
    return {left_segments_.items.begin(), left_segments_.items.end()};
  }
  // Whether equal rows see equal planes, corner by corner; for AlignmentMonitor. Also outside the region.
  [[nodiscard]] std::span<const RowOffset> row_offsets() const { return {row_offsets_.begin(), row_offsets_.end()}; }
  [[nodiscard]] std::span<const Line3> lines() const { return {lines_.begin(), lines_.end()}; }
  [[nodiscard]] const ImageLineSets& line_sets() const { return line_sets_; }
  // Of the model at hand, during StageDone(kCorrespondences), in no particular order.
  [[nodiscard]] std::span<const CorrespondingPair> corresponding_pairs() const { return pairs_.items(); }
  [[nodiscard]] std::size_t detection_count() const { return accepted_.size(); }
  // The corresponding line set behind detection i: which image line lies on which model edge. Empty when a prior found
  // it.
  [[nodiscard]] std::span<const SetMember> line_set(std::size_t i) const;
  [[nodiscard]] std::span<const PreparedModel> prepared_models() const { return {models_.begin(), models_.end()}; }
  [[nodiscard]] const PreparedModel& prepared_model(std::size_t i) const { return models_[i]; }
  // Of the model at hand, during StageDone(kHypotheses): coarse poses and promoted sets, best first.
  [[nodiscard]] std::span<const Hypothesis> hypotheses() const { return hypotheses_.items(); }
  [[nodiscard]] std::span<const CorrespondingSet> sets() const { return {sets_.begin(), sets_.end()}; }
  // Verified candidates of all models, by falling score: what was nearly reported, and why not.
  [[nodiscard]] std::span<const Candidate> candidates() const;

 private:
  using ImagePlane = std::array<std::uint8_t, kMaxPixels>;

  [[nodiscard]] ImageView View(const ImagePlane& plane) const {
    return {plane.data(), camera().width, camera().height, kMaxImageWidth};
  }
  [[nodiscard]] bool Searched(std::size_t m) const { return ((searched_ >> m) & 1U) != 0; }
  void SelectSegments();
  void MatchEyes();
  // The shared beginning of both Configure: the size, and of both Process: calibration, kind of camera and size.
  static bool Fits(int width, int height);
  [[nodiscard]] RecognizerError CheckImages(bool stereo, std::initializer_list<ImageView> images) const;
  void FindFeatures(ImageView left, ImageView right, StageTimer& timer, RecognitionStatistics& statistics);
  void FindFeatures(ImageView image, const DepthView& depth, StageTimer& timer, RecognitionStatistics& statistics);
  void FindLeftEdges(RecognitionStatistics& statistics);
  // From lines with depth on, for whichever camera.
  void RelateLines(StageTimer& timer, RecognitionStatistics& statistics);
  void Recognize(StageTimer& timer, RecognitionResult& result);
  [[nodiscard]] SceneImages ImagesFor(const RefineParams& params) const;
  void MatchModel(std::size_t m, StageTimer& timer, RecognitionResult& result);
  // Also counts the edge pixels into `pixels`. Only the left eye's edges become segments (`segments` not null).
  void FindEdges(const ImagePlane& image, const RectificationMap& map, SmoothPlane& smooth, EdgeMap& edge_map,
                 Segments* segments, ListUse& pixels);
  [[nodiscard]] SceneEdges Edges() const { return {camera(), left_edges_, right_edges_}; }
  // Adjusts to the end, from few samples first; not ok when nothing fits.
  void Adjust(const PreparedModel& model, const Pose& start, RefinedPose& out);
  // Adjusts from `start` and appends to refined_ what fits.
  void RefineFrom(std::size_t m, const Pose& start, Candidate& candidate);
  void RefinePriors(std::size_t m);
  void Judge(Candidate& candidate);

  // recognizer_report.cpp
  struct Rival {  // a pose that may be a mode
    Pose T_camera_model;
    float odds = 0;
  };
  using Rivals = FixedVector<Rival, kMaxRefined + kMaxPriors + kMaxNearTurns + 1>;
  void SetPriors(std::span<const PosePrior> priors);
  [[nodiscard]] Matrix3d ReferenceFor(const Candidate& candidate) const;
  void MakeCanonical(const Matrix3d& R_reference, Candidate& candidate) const;
  [[nodiscard]] bool IsRival(const Candidate& candidate, const Rivals& rivals, float min_odds);
  void FindTurnedRivals(const Candidate& candidate, float min_odds, Rivals& rivals);
  void FindModes(std::size_t i, std::span<const Candidate> candidates, const Matrix3d& R_reference,
                 Detection& detection);
  [[nodiscard]] Detection DetectionOf(const Candidate& candidate) const;
  void Report(RecognitionResult& result);

  RecognizerParams params_;
  bool configured_ = false;
  Rectification rectification_;
  FixedVector<ModelView, kMaxModels> views_;
  FixedVector<PreparedModel, kMaxModels> models_;  // of the same models, in the same order
  std::array<NearTurns, kMaxModels> near_turns_;   // of the same models
  std::uint32_t searched_ = 0;                     // bit m: models_[m] takes part
  static_assert(kMaxModels <= 32);
  ImageRegion region_;

  // Per frame, in the order of the flow.
  ImagePlane left_rectified_, right_rectified_;
  SmoothPlane left_smooth_, right_smooth_;
  NormalizedPlane left_normalized_, right_normalized_;
  EdgeMap left_edges_, right_edges_;
  Segments left_segments_;
  Segments searched_segments_;  // those in the region
  Corners corners_;
  DisparityMap disparity_;
  RowOffsets row_offsets_;
  Lines3 lines_;
  ImageLineSets line_sets_;
  // Per model.
  CorrespondingPairs pairs_;
  Hypotheses hypotheses_;
  CorrespondingSets sets_;
  FixedVector<Candidate, kMaxRefined + kMaxPriors> refined_;
  // Of all models.
  FixedVector<PosePrior, kMaxPriors> priors_;  // in the rectified frame
  Candidates candidates_;
  FixedVector<std::uint16_t, kMaxDetections> accepted_;

  SegmentScratch segment_scratch_;
  StereoScratch stereo_scratch_;
  // Of the stage at work: an eye's edge image, then the rows of the disparity map or the depth of every pixel, then the
  // costs of a corner.
  alignas(EdgeImage) alignas(DisparityScratch) alignas(DisparityImage) std::array<
      std::byte, std::max({sizeof(EdgeImage), sizeof(DisparityScratch), sizeof(DisparityImage)})> stage_scratch_;
  static_assert(sizeof(RowOffsetScratch) <= sizeof(EdgeImage) && alignof(RowOffsetScratch) <= alignof(EdgeImage));
  RefineScratch refine_scratch_;
  VerifyScratch verify_scratch_;
  ClaimMap claims_;
};

}  // namespace wirepose

#endif  // WIREPOSE_PIPELINE_RECOGNIZER_H_
