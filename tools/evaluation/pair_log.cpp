#include "tools/evaluation/pair_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wirepose::evaluation {
namespace {

constexpr double kMaxOffsetPx = 3, kMaxDisparityPx = 1;  // of a line from the edge that it shows
constexpr double kMaxOverrunPx = 6;

// Does the line show a part of the edge, seen at T?
bool Shows(const RectifiedCamera& camera, const Pose& T, const PreparedEdge& edge, const Line3& line) {
  const Vector3d a = T * edge.a.cast<double>(), b = T * edge.b.cast<double>();
  if (a.z() < 0.05 || b.z() < 0.05) return false;
  const Vector3d pa = camera.Project(a), pb = camera.Project(b);
  const Eigen::Vector2d d = (pb - pa).head<2>();
  const double length = d.norm();
  if (length < 1) return false;
  const Eigen::Vector2d u = d / length;
  const double overrun = kMaxOverrunPx + 0.05 * length;
  for (const Vector2& end : {line.segment.a, line.segment.b}) {
    const Eigen::Vector2d q = end.cast<double>() - pa.head<2>();
    if (std::abs(q.x() * u.y() - q.y() * u.x()) > kMaxOffsetPx) return false;
    if (q.dot(u) < -overrun || q.dot(u) > length + overrun) return false;
  }
  if (!line.has_depth) return true;
  const double along = (line.segment.Middle().cast<double>() - pa.head<2>()).dot(u) / length;
  const double expected = pa.z() + along * (pb.z() - pa.z());
  const double measured = 0.5 * static_cast<double>(line.disparity_a_px + line.disparity_b_px);
  return std::abs(measured - expected) < std::max(kMaxDisparityPx, 0.04 * expected);
}

// All pairs of one base line, and no others.
void OnlyBase(const ImageLineSets& all, std::size_t base, ImageLineSets& out) {
  out.pairs.clear();
  for (const ImageLinePair& pair : all.OfBase(base)) out.pairs.push_back(pair);
  const auto count = static_cast<std::uint16_t>(out.pairs.size());
  for (std::size_t b = 0; b < out.first.size(); ++b) out.first[b] = b <= base ? std::uint16_t{0} : count;
}

}  // namespace

PairLog::PairLog(const std::filesystem::path& file, const Recognizer& recognizer, StageObserver& next,
                 StageClock& clock)
    : out_(file),
      recognizer_(recognizer),
      next_(next),
      clock_(clock),
      sets_(std::make_unique<ImageLineSets>()),
      pairs_(std::make_unique<CorrespondingPairs>()) {
  out_ << "scene_id,im_id,obj_id,instance,weight,class";
  for (const char* name : PairTermNames()) out_ << ',' << name;
  out_ << '\n';
}

void PairLog::Start(const dataset::FrameEntry& frame) {
  frame_ = &frame;
  models_seen_ = 0;
}

void PairLog::DoStageDone(Stage stage) {
  next_.StageDone(stage);
  if (stage == Stage::kCorrespondences) WriteModel(recognizer_.prepared_model(models_seen_++));
  clock_.Skip();
}

void PairLog::WriteModel(const PreparedModel& model) {
  const std::vector<Truth> truth = TruthOf(model);
  lines_.clear();
  for (const Line3& line : recognizer_.lines()) lines_.push_back(line);
  for (std::size_t base = 0; base < lines_.size(); ++base) {
    OnlyBase(recognizer_.line_sets(), base, *sets_);
    if (sets_->pairs.empty()) continue;
    (void)FindCorrespondences({}, recognizer_.camera(), model, lines_, *sets_, *pairs_);
    for (const CorrespondingPair& match : pairs_->Sorted()) {
      const int instance = InstanceOf(model, truth, match);
      if (instance >= 0 || wrong_++ % kWrongPerRow == 0) WriteRow(model, match, instance);
    }
  }
}

std::vector<PairLog::Truth> PairLog::TruthOf(const PreparedModel& model) const {
  std::vector<Truth> all;
  for (std::size_t i = 0; i < frame_->gt.size(); ++i) {
    const dataset::TrueInstance& instance = frame_->gt[i];
    if (static_cast<std::uint32_t>(instance.obj_id) != model.view.id || instance.visib_fract < 0.4) continue;
    Truth& truth = all.emplace_back();
    truth.instance = static_cast<int>(i);
    const Pose T = recognizer_.T_rectified_raw() * instance.T_camera_model;
    for (const Pose& symmetry : model.symmetries) truth.poses.push_back(T * symmetry);
  }
  return all;
}

int PairLog::InstanceOf(const PreparedModel& model, const std::vector<Truth>& truth,
                        const CorrespondingPair& match) const {
  const ImageLinePair& pair = sets_->pairs[match.image_pair];
  const Line3 &base = lines_[pair.base], &other = lines_[pair.other];
  const PreparedEdge& edge = model.edges[match.base_edge];
  const RectifiedCamera& camera = recognizer_.camera();
  const auto right = [&](const Pose& T) {
    const Vector3d direction = T.R * edge.direction.cast<double>();
    return (direction.dot(base.Direction().cast<double>()) < 0) == (match.base_flipped != 0) &&
           Shows(camera, T, edge, base) && Shows(camera, T, model.edges[match.other_edge], other);
  };
  for (const Truth& instance : truth) {
    if (std::any_of(instance.poses.begin(), instance.poses.end(), right)) return instance.instance;
  }
  return -1;
}

void PairLog::WriteRow(const PreparedModel& model, const CorrespondingPair& match, int instance) {
  const PairClass c = ClassOf(sets_->pairs[match.image_pair], match.junction != 0);
  out_ << fmt::format("{},{},{},{},{},{}", frame_->scene_id, frame_->im_id, model.view.id, instance,
                      instance < 0 ? kWrongPerRow : 1, static_cast<int>(c));
  for (const float term : TermsOf(model, lines_, *sets_, match)) out_ << fmt::format(",{:.6g}", term);
  out_ << '\n';
}

}  // namespace wirepose::evaluation
