#include "pipeline/recognizer.h"

#include <algorithm>

#include "base/arena.h"

namespace wirepose {
namespace {

// Does the rectified pixel show a point of the raw image's region? Between the map's nodes the raw position moves by as
// much as the rectified one, to within the lens's change of scale over half a node's step: less than a pixel.
bool SeenIn(const ImageRegion& region, const RectificationMap& map, const Vector2& p) {
  constexpr int kStep = RectificationMap::kNodeStep;
  const int i = std::clamp(static_cast<int>(p.x()) / kStep, 0, RectificationMap::kNodesX - 1);
  const int j = std::clamp(static_cast<int>(p.y()) / kStep, 0, RectificationMap::kNodesY - 1);
  const auto& node = map.nodes[static_cast<std::size_t>(j * RectificationMap::kNodesX + i)];
  const float x = static_cast<float>(node.x) / 65536.0F + p.x() - static_cast<float>(i * kStep);
  const float y = static_cast<float>(node.y) / 65536.0F + p.y() - static_cast<float>(j * kStep);
  const float left = region.x, top = region.y;
  return x >= left && x < left + static_cast<float>(region.width) && y >= top &&
         y < top + static_cast<float>(region.height);
}

// One more filling of a list: its highest use, and all that did not fit.
void Count(std::size_t used, std::size_t capacity, std::uint32_t dropped, ListUse& list) {
  list.used = std::max(list.used, static_cast<std::uint32_t>(used));
  list.capacity = static_cast<std::uint32_t>(capacity);
  list.dropped += dropped;
}

// With the number of capacities.h, put in by the compiler: the core formats no text.
constexpr auto kTooManyModelsText = [] {
  static_assert(kMaxModels >= 10 && kMaxModels <= 99, "two digits");
  auto text = std::to_array("too many models; at most ## are searched for at once");
  auto* const digits = std::find(text.begin(), text.end(), '#');
  digits[0] = static_cast<char>('0' + kMaxModels / 10);
  digits[1] = static_cast<char>('0' + kMaxModels % 10);
  return text;
}();

}  // namespace

const char* StageName(Stage stage) {
  switch (stage) {
    case Stage::kRectify:
      return "rectify";
    case Stage::kSegments:
      return "segments";
    case Stage::kStereoLines:
      return "stereo_lines";
    case Stage::kLineSets:
      return "line_sets";
    case Stage::kCorrespondences:
      return "correspondences";
    case Stage::kHypotheses:
      return "hypotheses";
    case Stage::kVerify:
      return "verify";
    case Stage::kRefine:
      return "refine";
    case Stage::kSelect:
      return "select";
  }
  return "?";
}

const char* Describe(RecognizerError error) {
  switch (error) {
    case RecognizerError::kOk:
      return "ok";
    case RecognizerError::kBadCalibration:
      return "bad calibration: focal lengths and baseline must be positive and R a rotation; calibrate again";
    case RecognizerError::kImageTooLarge:
      return "calibrated image size is outside 64x64 to 640x480; bin or crop the camera image and calibrate at that "
             "size";
    case RecognizerError::kNotConfigured:
      return "no calibration; call Configure first";
    case RecognizerError::kImageSizeMismatch:
      return "the image is not of the calibrated size";
    case RecognizerError::kTooManyModels:
      return kTooManyModelsText.data();
    case RecognizerError::kDuplicateModel:
      return "two models have the same id; rebuild one with another --id";
    case RecognizerError::kOtherCamera:
      return "configured for the other kind of camera; call Configure with a stereo calibration before Process, with a "
             "depth calibration before ProcessDepth";
    case RecognizerError::kBadDepthUnit:
      return "the unit of depth is not above 0 and at most 1 m; give metres a unit, 0.001 for millimetres";
  }
  return "?";
}

bool Recognizer::Fits(int width, int height) {
  return width >= 64 && width <= kMaxImageWidth && height >= 64 && height <= kMaxImageHeight;
}

RecognizerError Recognizer::Configure(const StereoCalibration& calibration, const RecognizerParams& params) {
  if (!Fits(calibration.width, calibration.height)) return RecognizerError::kImageTooLarge;
  if (!ComputeRectification(calibration, rectification_)) return RecognizerError::kBadCalibration;
  params_ = params;
  configured_ = true;
  return RecognizerError::kOk;
}

RecognizerError Recognizer::Configure(const DepthCalibration& calibration, const RecognizerParams& params) {
  if (!Fits(calibration.width, calibration.height)) return RecognizerError::kImageTooLarge;
  if (!ComputeUndistortion(calibration, rectification_)) return RecognizerError::kBadCalibration;
  params_ = params;
  configured_ = true;
  return RecognizerError::kOk;
}

RecognizerError Recognizer::CheckImages(bool stereo, std::initializer_list<ImageView> images) const {
  if (!configured_) return RecognizerError::kNotConfigured;
  if (camera().has_right_image != stereo) return RecognizerError::kOtherCamera;
  for (const ImageView& image : images) {
    if (image.width != camera().width || image.height != camera().height || image.data == nullptr) {
      return RecognizerError::kImageSizeMismatch;
    }
  }
  return RecognizerError::kOk;
}

RecognizerError Recognizer::AddModel(const ModelView& model) {
  for (const PreparedModel& m : models_) {
    if (m.view.id == model.id) return RecognizerError::kDuplicateModel;
  }
  if (models_.full()) return RecognizerError::kTooManyModels;
  views_.push_back(model);
  models_.resize(models_.size() + 1);
  PrepareModel(model, models_.back());
  near_turns_[models_.size() - 1] = FindNearTurns(models_.back());
  searched_ |= 1U << (models_.size() - 1);
  return RecognizerError::kOk;
}

void Recognizer::ClearModels() {
  views_.clear();
  models_.clear();
  searched_ = 0;
}

std::span<const SetMember> Recognizer::line_set(std::size_t i) const {
  const auto& members = candidates()[accepted_[i]].members;
  return {members.begin(), members.end()};
}

std::span<const Candidate> Recognizer::candidates() const { return candidates_.items(); }

// The flow: frame -> rectified pair -> segments -> 3D lines -> line sets -> (for each model) correspondences ->
// hypotheses -> promoted sets -> refined, verified poses -> detections.
RecognizerError Recognizer::Process(ImageView left, ImageView right, std::span<const PosePrior> priors,
                                    StageObserver* observer, RecognitionResult& result) {
  result = {};
  if (const RecognizerError error = CheckImages(true, {left, right}); error != RecognizerError::kOk) return error;
  StageTimer timer(observer);
  FindFeatures(left, right, timer, result.statistics);
  SetPriors(priors);
  Recognize(timer, result);
  return RecognizerError::kOk;
}

RecognizerError Recognizer::ProcessDepth(ImageView image, const DepthView& depth, StageObserver* observer,
                                         RecognitionResult& result) {
  result = {};
  if (const RecognizerError error = CheckImages(false, {image}); error != RecognizerError::kOk) return error;
  if (depth.pixels.width != image.width || depth.pixels.height != image.height || depth.pixels.data == nullptr) {
    return RecognizerError::kImageSizeMismatch;
  }
  if (!(depth.unit_m > 0 && depth.unit_m <= 1)) return RecognizerError::kBadDepthUnit;
  StageTimer timer(observer);
  FindFeatures(image, depth, timer, result.statistics);
  SetPriors({});
  Recognize(timer, result);
  return RecognizerError::kOk;
}

void Recognizer::Recognize(StageTimer& timer, RecognitionResult& result) {
  candidates_.clear();
  for (std::size_t m = 0; m < models_.size(); ++m) {
    if (Searched(m)) MatchModel(m, timer, result);
  }
  Report(result);
  timer.Done(Stage::kSelect);
}

void Recognizer::SelectSegments() {
  searched_segments_.items.clear();
  for (const Segment2& segment : left_segments_.items) {
    if (region_.Whole() || SeenIn(region_, rectification_.left, segment.Middle()))
      searched_segments_.items.push_back(segment);
  }
}

void Recognizer::FindEdges(const ImagePlane& image, const RectificationMap& map, SmoothPlane& smooth, EdgeMap& edge_map,
                           Segments* segments, ListUse& pixels) {
  Arena arena(stage_scratch_);
  EdgeImage* const created = arena.Create<EdgeImage>();
  Check(created != nullptr);  // stage_scratch_ is sized for the largest of its users
  EdgeImage& edges = *created;
  SmoothImage(View(image), smooth);
  FindRidges(smooth, camera().width, camera().height, map, params_.edges, edges);
  Count(edges.ridge_count, kMaxRidgePixels, edges.ridge_dropped, pixels);
  BuildEdgeMap(edges, edge_map);
  if (segments != nullptr) FindSegments(params_.segments, edges, segment_scratch_, *segments);
}

void Recognizer::FindFeatures(ImageView left, ImageView right, StageTimer& timer, RecognitionStatistics& statistics) {
  const int width = camera().width, height = camera().height;
  RectifyImage(left, rectification_.left, {left_rectified_.data(), width, height, kMaxImageWidth});
  RectifyImage(right, rectification_.right, {right_rectified_.data(), width, height, kMaxImageWidth});
  timer.Done(Stage::kRectify);

  FindEdges(right_rectified_, rectification_.right, right_smooth_, right_edges_, nullptr, statistics.edge_pixels);
  FindLeftEdges(statistics);
  FindCorners(params_.row_offsets, left_smooth_, width, height, left_segments_, corners_);
  SelectSegments();
  timer.Done(Stage::kSegments);

  MatchEyes();
  timer.Done(Stage::kStereoLines);
  RelateLines(timer, statistics);
}

// One image sees no right edges: an empty map contains no place, so that nobody finds anything there or misses it.
void Recognizer::FindFeatures(ImageView image, const DepthView& depth, StageTimer& timer,
                              RecognitionStatistics& statistics) {
  RectifyImage(image, rectification_.left, {left_rectified_.data(), camera().width, camera().height, kMaxImageWidth});
  timer.Done(Stage::kRectify);

  right_edges_.width = right_edges_.height = 0;
  right_edges_.threshold = right_edges_.background = 0;
  row_offsets_.clear();
  FindLeftEdges(statistics);
  SelectSegments();
  timer.Done(Stage::kSegments);

  Arena arena(stage_scratch_);
  auto& disparities = *arena.Create<DisparityImage>();
  FillDisparityImage(params_.depth_image, camera(), rectification_.left, depth, disparities);
  ShrinkDisparity(disparities, disparity_);
  PlaceLines(params_.depth_lines, camera(), disparities, searched_segments_, lines_);
  timer.Done(Stage::kStereoLines);
  RelateLines(timer, statistics);
}

void Recognizer::FindLeftEdges(RecognitionStatistics& statistics) {
  FindEdges(left_rectified_, rectification_.left, left_smooth_, left_edges_, &left_segments_, statistics.edge_pixels);
}

void Recognizer::RelateLines(StageTimer& timer, RecognitionStatistics& statistics) {
  FindLineSets(params_.line_sets, camera(), lines_, line_sets_);
  timer.Done(Stage::kLineSets);

  Count(left_segments_.items.size(), kMaxSegments, left_segments_.dropped, statistics.left_segments);
  Count(lines_.size(), kMaxSegments, 0, statistics.lines);
  Count(line_sets_.pairs.size(), kMaxImageLinePairs, line_sets_.dropped, statistics.line_sets);
}

void Recognizer::MatchEyes() {
  const int width = camera().width, height = camera().height;
  NormalizeLocally(View(left_rectified_), left_normalized_);
  NormalizeLocally(View(right_rectified_), right_normalized_);
  {
    Arena arena(stage_scratch_);
    ComputeDisparityMap(params_.disparity, width, height, left_normalized_, right_normalized_,
                        *arena.Create<DisparityScratch>(), disparity_);
  }
  MatchLines(params_.stereo, {camera(), left_normalized_, right_normalized_, right_smooth_, rectification_.right},
             searched_segments_, stereo_scratch_, lines_);
  Arena arena(stage_scratch_);
  MeasureRowOffsets(params_.row_offsets,
                    {width, height, left_normalized_, right_normalized_, left_smooth_, right_smooth_,
                     rectification_.left, rectification_.right},
                    corners_, *arena.Create<RowOffsetScratch>(), row_offsets_);
}

void Recognizer::MatchModel(std::size_t m, StageTimer& timer, RecognitionResult& result) {
  const PreparedModel& model = models_[m];
  const bool all_pairs = FindCorrespondences(params_.correspondences, camera(), model, lines_, line_sets_, pairs_);
  const std::span<const CorrespondingPair> pairs = pairs_.Sorted();
  Count(pairs.size(), kMaxCorrespondences, pairs_.dropped(), result.statistics.correspondences);
  timer.Done(Stage::kCorrespondences);

  const SceneEdges scene = Edges();
  const bool all_poses = MakeHypotheses(params_.hypotheses, scene, model, lines_, line_sets_, pairs, hypotheses_);
  result.budget_hit = result.budget_hit || !all_pairs || !all_poses;
  Count(hypotheses_.size(), kMaxHypotheses, hypotheses_.dropped(), result.statistics.hypotheses);
  const auto& hypotheses = hypotheses_.Sorted();
  const PoseScorer scorer(params_.hypotheses.score, scene, model);
  const std::uint32_t dropped =
      PromoteSets(params_.promotion, scorer, camera(), model, lines_, {hypotheses.begin(), hypotheses.end()}, sets_);
  Count(sets_.size(), kMaxPromoted, dropped, result.statistics.promoted);
  timer.Done(Stage::kHypotheses);

  refined_.clear();
  const std::span<const CorrespondingSet> sets = WorthRefining(params_.promotion, sets_);
  for (const CorrespondingSet& set : sets) {
    Candidate candidate;
    candidate.order = static_cast<std::uint16_t>(&set - sets.data());
    candidate.members = set.members;
    RefineFrom(m, {Orthonormalize(set.R.cast<double>()), set.t.cast<double>()}, candidate);
  }
  RefinePriors(m);
  timer.Done(Stage::kRefine);

  for (Candidate& candidate : refined_) {
    Judge(candidate);
    candidates_.Push(candidate);
  }
  timer.Done(Stage::kVerify);
}

SceneImages Recognizer::ImagesFor(const RefineParams& params) const {
  const bool surface = params.surface.in_stereo || !camera().has_right_image;
  return {camera(), left_smooth_, right_smooth_, surface ? &disparity_ : nullptr};
}

// Right poses and others differ more when they lie where their edges are: where the second pass does not fit, the pose
// of the first one stays.
void Recognizer::Adjust(const PreparedModel& model, const Pose& start, RefinedPose& out) {
  RefinePose(params_.refine, ImagesFor(params_.refine), model, start, refine_scratch_, out);
  if (!out.ok) return;
  RefinedPose polished;
  RefinePose(params_.polish, ImagesFor(params_.polish), model, out.T_camera_model, refine_scratch_, polished);
  if (polished.ok) out = polished;
}

void Recognizer::RefineFrom(std::size_t m, const Pose& start, Candidate& candidate) {
  candidate.model = static_cast<std::uint16_t>(m);
  Adjust(models_[m], start, candidate.pose);
  if (candidate.pose.ok) refined_.push_back(candidate);
}

// A prior at which a candidate lies already would only lead there again.
void Recognizer::RefinePriors(std::size_t m) {
  const PreparedModel& model = models_[m];
  const float tolerance = params_.promotion.duplicate_share * model.view.diameter_m;
  for (std::size_t i = 0; i < priors_.size(); ++i) {
    const Pose& start = priors_[i].T_camera_model;
    if (priors_[i].model_id != model.view.id || !(start.t.z() > 0)) continue;
    const bool known = std::any_of(refined_.begin(), refined_.end(), [&](const Candidate& c) {
      const Pose& T = c.pose.T_camera_model;
      return IsSamePose(model, T.R.cast<float>(), T.t.cast<float>(), start.R.cast<float>(), start.t.cast<float>(),
                        tolerance);
    });
    if (known) continue;
    Candidate candidate;
    candidate.order = static_cast<std::uint16_t>(kMaxRefined + i);
    RefineFrom(m, start, candidate);
  }
}

void Recognizer::Judge(Candidate& candidate) {
  const VerifyInput input{camera(),      left_edges_, right_edges_,   left_smooth_,
                          right_smooth_, disparity_,  left_segments()};
  GatherEvidence(params_.verify, input, models_[candidate.model], candidate.pose, verify_scratch_, candidate.evidence);
  candidate.score = ScoreOf(DefaultScoreTable(), TermsOf(candidate.evidence));
}

}  // namespace wirepose
