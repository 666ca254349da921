#include "tools/evaluation/report/frame_note.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <span>

#include <fmt/format.h>

#include "tools/evaluation/evidence_terms.h"
#include "tools/evaluation/vertex_error.h"
#include "tools/overlay/visible_edges.h"

namespace wirepose::evaluation {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRightD = 0.1;      // as a hit of the metrics
constexpr double kSamePlaceD = 0.3;  // poses of one model nearer than this are one report

double Tenth(double px) { return std::round(px * 10) / 10; }

std::string Base64(const std::vector<unsigned char>& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) { return i + k < bytes.size() ? std::uint32_t{bytes[i + k]} : 0U; };
    const std::uint32_t three = byte(0) << 16U | byte(1) << 8U | byte(2);
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? kDigits[three >> (18U - 6U * k) & 63U] : '=';
    }
  }
  return out;
}

Json ToJson(std::span<const Segment2> segments) {
  Json list = Json::array();
  for (const Segment2& s : segments) {
    for (const float v : {s.a.x(), s.a.y(), s.b.x(), s.b.y()}) list.push_back(Tenth(static_cast<double>(v)));
  }
  return list;
}

Json ToJson(std::span<const Line3> lines) {
  Json list = Json::array();
  for (const Line3& l : lines) {
    if (!l.has_depth) continue;
    const Segment2& s = l.segment;
    for (const float v : {s.a.x(), s.a.y(), l.disparity_a_px, s.b.x(), s.b.y(), l.disparity_b_px}) {
      list.push_back(Tenth(static_cast<double>(v)));
    }
  }
  return list;
}

// Grows around points; `Cut` gives the part inside the image.
class Bounds {
 public:
  void Add(double x, double y) {
    low_ = low_.cwiseMin(Eigen::Vector2d(x, y));
    high_ = high_.cwiseMax(Eigen::Vector2d(x, y));
  }
  [[nodiscard]] Json Cut(const RectifiedCamera& camera) const {
    const Eigen::Vector2d size(camera.width, camera.height);
    const Eigen::Vector2d low = low_.cwiseMax(0), high = high_.cwiseMin(size);
    if ((high - low).minCoeff() <= 0) return nullptr;
    return {Tenth(low.x()), Tenth(low.y()), Tenth(high.x()), Tenth(high.y())};
  }

 private:
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(1e9), high_ = Eigen::Vector2d::Constant(-1e9);
};

Json DrawPose(const RectifiedCamera& camera, const ModelView& model, const Pose& T_rectified_model) {
  Json seen = Json::array(), hidden = Json::array();
  Bounds bounds;
  for (const overlay::EdgePiece& piece : overlay::CutEdges(model, T_rectified_model)) {
    for (const Vector3d& end : {piece.a, piece.b}) {
      const Vector3d p = camera.Project(end);
      Json& list = piece.hidden ? hidden : seen;
      for (int k = 0; k < 3; ++k) list.push_back(Tenth(p[k]));
      if (!piece.hidden) bounds.Add(p.x(), p.y());
    }
  }
  return {{"seen", seen}, {"hidden", hidden}, {"box", bounds.Cut(camera)}, {"range_m", T_rectified_model.t.norm()}};
}

Json EvidenceToJson(const Candidate& candidate) {
  Json json = Json::object();
  for (const EvidenceTerm& term : NamedTerms(candidate)) json[term.name] = term.value;
  return json;
}

const PreparedModel* FindPrepared(const Recognizer& recognizer, std::uint32_t id) {
  for (std::size_t m = 0; m < recognizer.models().size(); ++m) {
    if (recognizer.prepared_model(m).view.id == id) return &recognizer.prepared_model(m);
  }
  return nullptr;
}

// The candidate that became this detection: the same model at the same place.
const Candidate* CandidateOf(const Recognizer& recognizer, const Detection& detection) {
  const Vector3d at = (recognizer.T_rectified_raw() * detection.T_camera_model).t;
  const Candidate* nearest = nullptr;
  const auto distance = [&](const Candidate& c) { return (c.pose.T_camera_model.t - at).norm(); };
  for (const Candidate& c : recognizer.candidates()) {
    if (recognizer.prepared_model(c.model).view.id != detection.model_id) continue;
    if (nearest == nullptr || distance(c) < distance(*nearest)) nearest = &c;
  }
  return nearest;
}

DetectionNote NoteDetection(const FrameView& view, const PreparedModel& model, const Detection& detection) {
  const Recognizer& recognizer = view.recognizer;
  DetectionNote note;
  note.facts = RelateToTruth(model, detection.T_camera_model, view.entry.gt, view.models);
  note.json = {{"object", detection.model_id}, {"score", detection.score}};
  note.json["pose"] =
      DrawPose(recognizer.camera(), model.view, recognizer.T_rectified_raw() * detection.T_camera_model);
  const Candidate* candidate = CandidateOf(recognizer, detection);
  note.json["evidence"] = candidate != nullptr ? EvidenceToJson(*candidate) : Json();
  return note;
}

Json ToJson(const TracedPose& pose) {
  if (pose.error_d >= 9) return nullptr;
  return {{"error_d", pose.error_d}, {"rank", pose.rank}, {"score", pose.score}};
}

Json NoteInstance(const FrameView& view, std::size_t i) {
  const dataset::TrueInstance& truth = view.entry.gt[i];
  const InstanceTrace& trace = view.traces[i];
  const Recognizer& recognizer = view.recognizer;
  Json json{{"object", truth.obj_id}, {"visible", truth.visib_fract}};
  const ModelView* model = view.models.Find(static_cast<std::uint32_t>(truth.obj_id));
  if (model == nullptr) {
    json["cause"] = "not searched";
    return json;
  }
  json["pose"] = DrawPose(recognizer.camera(), *model, recognizer.T_rectified_raw() * truth.T_camera_model);
  json["cause"] = CauseName(CauseOf(trace));
  json["trace"] = {{"visible_edges", trace.visible_edges},
                   {"found_edges", trace.found_edges},
                   {"deep_edges", trace.deep_edges},
                   {"hypothesis", ToJson(trace.hypothesis)},
                   {"set", ToJson(trace.set)},
                   {"candidate", ToJson(trace.candidate)}};
  if (trace.candidate.error_d >= 9) return json;
  const Candidate& nearest = recognizer.candidates()[trace.candidate.rank];
  json["candidate"] = DrawPose(recognizer.camera(), *model, nearest.pose.T_camera_model);
  json["candidate"]["evidence"] = EvidenceToJson(nearest);
  return json;
}

}  // namespace

std::string EncodePicture(ImageView image) {
  if (image.data == nullptr || image.width <= 0) return {};
  cv::Mat grey(image.height, image.width, CV_8UC1);
  for (int y = 0; y < image.height; ++y) std::copy_n(image.row(y), image.width, grey.ptr(y));
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".jpg", grey, bytes, {cv::IMWRITE_JPEG_QUALITY, 80, cv::IMWRITE_JPEG_OPTIMIZE, 1})) return {};
  return "data:image/jpeg;base64," + Base64(bytes);
}

Result<FrameNote, std::string> TakeNote(const FrameView& view, double min_score) {
  const Recognizer& recognizer = view.recognizer;
  FrameNote note;
  note.json = {
      {"scene", view.entry.scene_id},
      {"image", view.entry.im_id},
      {"width", recognizer.camera().width},
      {"height", recognizer.camera().height},
      {"f_baseline", recognizer.camera().f * recognizer.camera().baseline},
      {"pictures",
       {{"left", EncodePicture(recognizer.left_rectified())}, {"right", EncodePicture(recognizer.right_rectified())}}},
      {"segments", ToJson(recognizer.left_segments())},
      {"lines", ToJson(recognizer.lines())}};
  if (note.json["pictures"]["left"] == "") {
    return unexpected<std::string>(
        fmt::format("{}: cannot be made a JPEG for the report; leave --report out", view.entry.left_path.string()));
  }
  for (const Detection& d : view.result.detections) {
    const PreparedModel* model = FindPrepared(recognizer, d.model_id);
    if (model == nullptr || static_cast<double>(d.score) < min_score) continue;
    note.detections.push_back(NoteDetection(view, *model, d));
  }
  for (std::size_t i = 0; i < view.entry.gt.size(); ++i) note.instances.push_back(NoteInstance(view, i));
  note.unreported = UnreportedCandidates(view);
  return note;
}

std::vector<Estimate> UnreportedCandidates(const FrameView& view) {
  struct Taken {
    std::uint32_t model_id;
    Pose T_raw_model;
  };
  std::vector<Taken> taken;
  for (const Detection& d : view.result.detections) taken.push_back({d.model_id, d.T_camera_model});
  std::vector<Estimate> unreported;
  for (const Candidate& c : view.recognizer.candidates()) {
    const PreparedModel& model = view.recognizer.prepared_model(c.model);
    Detection d;
    d.model_id = model.view.id;
    d.score = c.score;
    d.T_camera_model = view.recognizer.T_rectified_raw().Inverse() * c.pose.T_camera_model;
    const bool is_taken = std::ranges::any_of(taken, [&](const Taken& t) {
      return t.model_id == d.model_id && RelativeVertexError(model, d.T_camera_model, t.T_raw_model) < kSamePlaceD;
    });
    if (is_taken) continue;
    taken.push_back({d.model_id, d.T_camera_model});
    unreported.push_back(ToEstimate(d, view.entry, -1));
  }
  return unreported;
}

std::vector<ScoredDetection> ScoredCandidates(const FrameView& view, double min_visible_fraction) {
  std::vector<ScoredDetection> scored;
  for (const Candidate& c : view.recognizer.candidates()) {
    const PreparedModel& model = view.recognizer.prepared_model(c.model);
    const Pose T_raw_model = view.recognizer.T_rectified_raw().Inverse() * c.pose.T_camera_model;
    bool right = false, counts = true;
    for (const dataset::TrueInstance& truth : view.entry.gt) {
      if (static_cast<std::uint32_t>(truth.obj_id) != model.view.id) continue;
      if (RelativeVertexError(model, T_raw_model, truth.T_camera_model) >= kRightD) continue;
      right = true;
      counts = truth.visib_fract >= min_visible_fraction;
    }
    if (counts) scored.push_back({static_cast<double>(c.score), right});
  }
  return scored;
}

}  // namespace wirepose::evaluation
