// Messages filled to the bounds of their types: the largest that can be sent.
#ifndef WIREPOSE_TESTS_PUBLISH_FULL_MESSAGES_H_
#define WIREPOSE_TESTS_PUBLISH_FULL_MESSAGES_H_

#include "publish/messages.h"
#include "reports_for_test.h"

namespace wirepose::test {

inline const std::string& LongText() {
  static const std::string text(300, 'x');
  return text;
}

inline ModelLabels FullLabels() {
  ModelLabels labels;
  for (std::uint32_t i = 0; i < kMaxModels; ++i)
    labels.push_back({100 + i, i, {LongText()}, Vector3::Zero(), Vector3::Zero(), true});
  return labels;
}

// Every list full, every text longer than its bound.
inline FrameReport FullFrame(std::mt19937& random) {
  FrameReport report = RandomReport(random, kMaxDetections);
  report.models = FullLabels();
  for (Detection& detection : report.result.detections) {
    detection.model_id = 100 + kMaxModels - 1;
    detection.track_id = 4'000'000'000;
    while (!detection.modes.full()) detection.modes.push_back({RandomPose(random), 0.25F});
  }
  return report;
}

inline HealthReport FullHealth() {
  HealthReport report;
  report.state = HealthState::kCameraLost;
  report.camera = LongText();
  report.camera_status = LongText();
  report.last_error = LongText();
  report.rows = {RowState::kVaryingOffset, 32, -1.5F, 0.75F, 1.25F, 2.5F};
  while (!report.stage_times.full()) report.stage_times.push_back({{LongText()}, 1, 2, 3});
  report.models = FullLabels();
  return report;
}

// As many points as fit, and the most markers.
inline SceneReport FullScene(std::mt19937& random) {
  SceneReport scene;
  while (!scene.points.full()) scene.points.push_back({1, 2, static_cast<float>(scene.points.size())});
  constexpr std::uint16_t kShare = kMaxScenePoints / (2 * kMaxDetections + 1) / 2 * 2;
  std::uint16_t first = 0;
  const auto take = [&first](std::uint16_t count) {
    const SceneLines lines{first, count};
    first = static_cast<std::uint16_t>(first + count);
    return lines;
  };
  while (!scene.objects.full()) {
    SceneObject object;
    object.label = LongText();
    object.T_camera_model = RandomPose(random);
    object.wireframe = take(kShare);
    object.line_set = take(kShare);
    scene.objects.push_back(object);
  }
  scene.lines = take(static_cast<std::uint16_t>(kMaxScenePoints - first));
  return scene;
}

inline CommandAnswer FullAnswer() {
  CommandAnswer answer;
  answer.command.sender = LongText();
  answer.command.request_id = 0x0123456789ABCDEF;
  answer.command.action = CommandAction::kSetRegion;
  answer.reason = LongText();
  while (!answer.searched_ids.full()) answer.searched_ids.push_back(7);
  answer.region = {1, 2, 3, 4};
  return answer;
}

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_PUBLISH_FULL_MESSAGES_H_
