#include "publish/scene_report.h"

#include <algorithm>
#include <cstdio>

namespace wirepose {
namespace {

ScenePoint PointOf(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

// Appends lines to the report until it is full.
class LineWriter {
 public:
  explicit LineWriter(SceneReport& scene) : scene_(scene), first_(scene.points.size()) {}

  void Add(const Vector3& a, const Vector3& b) {
    if (scene_.points.size() + 2 > scene_.points.capacity()) {
      ++scene_.dropped;
      return;
    }
    scene_.points.push_back(PointOf(a));
    scene_.points.push_back(PointOf(b));
  }
  [[nodiscard]] SceneLines Written() const {
    return {static_cast<std::uint16_t>(first_), static_cast<std::uint16_t>(scene_.points.size() - first_)};
  }

 private:
  SceneReport& scene_;
  std::size_t first_;
};

const PreparedModel* FindModel(const Recognizer& recognizer, std::uint32_t id) {
  for (std::size_t m = 0; m < recognizer.models().size(); ++m) {
    if (recognizer.models()[m].id == id) return &recognizer.prepared_model(m);
  }
  return nullptr;
}

FixedText<64> LabelOf(const PreparedModel& model, const Detection& detection) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*s %.2f", static_cast<int>(model.view.name.size()), model.view.name.data(),
                static_cast<double>(detection.score));
  return {std::string_view(text)};
}

SceneLines AddWireframe(const PreparedModel& model, const Pose& T_camera_model, SceneReport& scene) {
  LineWriter writer(scene);
  const Vector3 eye = T_camera_model.Inverse().t.cast<float>();
  const EdgeBits visible = model.VisibleEdges(eye);
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    if (HasEdge(visible, e)) writer.Add(model.edges[e].a, model.edges[e].b);
  }
  return writer.Written();
}

}  // namespace

void FillScene(const Recognizer& recognizer, const RecognitionResult& result, SceneReport& scene) {
  scene.objects.clear();
  scene.points.clear();
  scene.dropped = 0;
  const Matrix3 R_raw_rectified = recognizer.T_rectified_raw().R.transpose().cast<float>();
  const auto add = [&](const Line3& line, LineWriter& writer) {
    if (line.has_depth) writer.Add(R_raw_rectified * line.a, R_raw_rectified * line.b);
  };
  for (std::size_t i = 0; i < result.detections.size(); ++i) {
    const Detection& detection = result.detections[i];
    const PreparedModel* const model = FindModel(recognizer, detection.model_id);
    if (model == nullptr) continue;
    SceneObject object;
    object.label = LabelOf(*model, detection);
    object.T_camera_model = detection.T_camera_model;
    object.wireframe = AddWireframe(*model, detection.T_camera_model, scene);
    LineWriter writer(scene);
    for (const SetMember& member : recognizer.line_set(i)) add(recognizer.lines()[member.line], writer);
    object.line_set = writer.Written();
    scene.objects.push_back(object);
  }
  LineWriter writer(scene);
  for (const Line3& line : recognizer.lines()) add(line, writer);
  scene.lines = writer.Written();
}

}  // namespace wirepose
