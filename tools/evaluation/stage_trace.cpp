#include "tools/evaluation/stage_trace.h"

#include <algorithm>
#include <cmath>

#include "tools/evaluation/vertex_error.h"

namespace wirepose::evaluation {
namespace {

// A projected model edge: end points in the left image and their disparities.
struct ImageEdge {
  Eigen::Vector2d a, b;
  double disparity_a = 0, disparity_b = 0;
};

bool Project(const RectifiedCamera& camera, const PreparedEdge& edge, const Pose& T, ImageEdge& out) {
  const Vector3d a = T * edge.a.cast<double>(), b = T * edge.b.cast<double>();
  if (a.z() < 0.05 || b.z() < 0.05) return false;
  out.a = {camera.f * a.x() / a.z() + camera.cx, camera.f * a.y() / a.z() + camera.cy};
  out.b = {camera.f * b.x() / b.z() + camera.cx, camera.f * b.y() / b.z() + camera.cy};
  out.disparity_a = camera.f * camera.baseline / a.z();
  out.disparity_b = camera.f * camera.baseline / b.z();
  return true;
}

// Share of the edge that the segment covers, if it lies within 3 px of it.
double Cover(const ImageEdge& edge, const Segment2& segment) {
  const Eigen::Vector2d d = edge.b - edge.a;
  const double length = d.norm();
  const Eigen::Vector2d u = d / length;
  double s[2];
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d q = (i == 0 ? segment.a : segment.b).cast<double>() - edge.a;
    if (std::abs(q.x() * u.y() - q.y() * u.x()) > 3) return 0;
    s[i] = std::clamp(q.dot(u), 0.0, length);
  }
  return std::abs(s[1] - s[0]) / length;
}

bool DepthAgrees(const ImageEdge& edge, const Line3& line) {
  const Eigen::Vector2d d = edge.b - edge.a;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d q = (i == 0 ? line.segment.a : line.segment.b).cast<double>();
    const double s = (q - edge.a).dot(d) / d.squaredNorm();
    const double expected = edge.disparity_a + s * (edge.disparity_b - edge.disparity_a);
    const auto measured = static_cast<double>(i == 0 ? line.disparity_a_px : line.disparity_b_px);
    if (std::abs(measured - expected) > std::max(1.0, 0.03 * expected)) return false;
  }
  return true;
}

void TraceEdge(const ImageEdge& edge, std::span<const Line3> lines, InstanceTrace& trace) {
  ++trace.visible_edges;
  double found = 0, deep = 0;
  for (const Line3& line : lines) {
    const double cover = Cover(edge, line.segment);
    found += cover;
    if (cover > 0 && line.has_depth && DepthAgrees(edge, line)) deep += cover;
  }
  if (found >= 0.5) ++trace.found_edges;
  if (deep >= 0.5) ++trace.deep_edges;
}

}  // namespace

std::string_view CauseName(MissCause cause) {
  switch (cause) {
    case MissCause::kNone:
      return "found";
    case MissCause::kNoLines:
      return "no lines";
    case MissCause::kNoHypothesis:
      return "no hypothesis";
    case MissCause::kRankedOut:
      return "ranked out";
    case MissCause::kWrongPose:
      return "wrong pose";
    case MissCause::kRejected:
      return "rejected";
  }
  return "?";
}

MissCause CauseOf(const InstanceTrace& trace) {
  if (trace.detected) return MissCause::kNone;
  if (trace.candidate.error_d < 0.1) return MissCause::kRejected;
  if (trace.set.error_d < 0.2) return MissCause::kWrongPose;
  if (trace.hypothesis.error_d < 0.3) return MissCause::kRankedOut;
  return trace.deep_edges == 0 || trace.found_edges < 2 ? MissCause::kNoLines : MissCause::kNoHypothesis;
}

void StageTrace::Start(const std::vector<dataset::TrueInstance>& truth) {
  truth_ = &truth;
  models_seen_ = 0;
  traces_.assign(truth.size(), {});
  for (std::size_t i = 0; i < truth.size(); ++i) {
    traces_[i].object_id = truth[i].obj_id;
    traces_[i].visible_fraction = truth[i].visib_fract;
    traces_[i].depth_m = truth[i].T_camera_model.t.z();
  }
}

void StageTrace::DoStageDone(Stage stage) {
  if (clock_ != nullptr) clock_->StageDone(stage);
  const auto pose_of = [](const auto& p) { return Pose{p.R.template cast<double>(), p.t.template cast<double>()}; };
  switch (stage) {
    case Stage::kStereoLines:
      TraceLines();
      break;
    case Stage::kHypotheses:
      TracePoses(recognizer_.hypotheses(), &InstanceTrace::hypothesis, pose_of);
      TracePoses(recognizer_.sets(), &InstanceTrace::set, pose_of);
      ++models_seen_;
      break;
    default:
      break;
  }
  if (clock_ != nullptr) clock_->Skip();
}

void StageTrace::TraceLines() {
  for (std::size_t i = 0; i < traces_.size(); ++i) {
    for (std::size_t m = 0; m < recognizer_.models().size(); ++m) {
      const PreparedModel& model = recognizer_.prepared_model(m);
      if (model.view.id != static_cast<std::uint32_t>(traces_[i].object_id)) continue;
      const Pose T = recognizer_.T_rectified_raw() * (*truth_)[i].T_camera_model;
      const EdgeBits visible = model.VisibleEdges((-(T.R.transpose() * T.t)).cast<float>());
      for (std::size_t e = 0; e < model.edges.size(); ++e) {
        ImageEdge edge;
        if (!HasEdge(visible, e) || !Project(recognizer_.camera(), model.edges[e], T, edge)) continue;
        if ((edge.b - edge.a).norm() >= 8) TraceEdge(edge, recognizer_.lines(), traces_[i]);
      }
    }
  }
}

template <typename List, typename PoseOf>
void StageTrace::TracePoses(const List& list, TracedPose InstanceTrace::*slot, const PoseOf& pose_of) {
  const PreparedModel& model = recognizer_.prepared_model(models_seen_);
  for (std::size_t i = 0; i < traces_.size(); ++i) {
    if (model.view.id != static_cast<std::uint32_t>(traces_[i].object_id)) continue;
    const Pose truth = recognizer_.T_rectified_raw() * (*truth_)[i].T_camera_model;
    TracedPose& nearest = traces_[i].*slot;
    std::size_t rank = 0;
    for (const auto& item : list) {
      const double error = RelativeVertexError(model, pose_of(item), truth);
      if (error < nearest.error_d) nearest = {error, rank, item.score};
      ++rank;
    }
  }
}

const std::vector<InstanceTrace>& StageTrace::Finish(const RecognitionResult& result) {
  for (std::size_t i = 0; i < traces_.size(); ++i) {
    InstanceTrace& trace = traces_[i];
    std::size_t rank = 0;
    for (const Candidate& c : recognizer_.candidates()) {
      const PreparedModel& model = recognizer_.prepared_model(c.model);
      if (model.view.id == static_cast<std::uint32_t>(trace.object_id)) {
        const Pose truth = recognizer_.T_rectified_raw() * (*truth_)[i].T_camera_model;
        const double error = RelativeVertexError(model, c.pose.T_camera_model, truth);
        if (error < trace.candidate.error_d) trace.candidate = {error, rank, c.score};
      }
      ++rank;
    }
    for (const Detection& d : result.detections) {
      if (d.model_id != static_cast<std::uint32_t>(trace.object_id)) continue;
      for (std::size_t m = 0; m < recognizer_.models().size(); ++m) {
        const PreparedModel& model = recognizer_.prepared_model(m);
        if (model.view.id != d.model_id) continue;
        trace.detected =
            trace.detected || RelativeVertexError(model, d.T_camera_model, (*truth_)[i].T_camera_model) < 0.1;
      }
    }
  }
  return traces_;
}

}  // namespace wirepose::evaluation
