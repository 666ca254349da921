// Reports with content for the tests of this room.
#ifndef WIREPOSE_TESTS_PUBLISH_REPORTS_FOR_TEST_H_
#define WIREPOSE_TESTS_PUBLISH_REPORTS_FOR_TEST_H_

#include <random>

#include "model/model_view.h"
#include "publish/reports.h"

namespace wirepose::test {

inline Matrix3d RandomRotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

inline Pose RandomPose(std::mt19937& random) {
  std::uniform_real_distribution<double> metre(-2, 2);
  return {RandomRotation(random), {metre(random), metre(random), metre(random)}};
}

// Symmetric positive definite, every element different from all others but its twin.
inline Matrix6d RandomCovariance(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Matrix6d A;
  for (Eigen::Index i = 0; i < 36; ++i) A(i) = normal(random);
  return 1e-4 * (A * A.transpose() + Matrix6d::Identity());
}

inline ModelView MakeModel(std::uint32_t id, std::string_view name) {
  ModelView model;
  model.id = id;
  model.name = name;
  model.checksum = 0xC0FFEE00U + id;
  model.box_min_m = {-0.1F, -0.2F, 0.0F};
  model.box_max_m = {0.3F, 0.2F, 0.5F};
  return model;
}

// As many as there can be, with ids from 100 on; the first and the last are searched for.
inline ModelLabels AllLabels() {
  FixedVector<ModelView, kMaxModels> models;
  while (!models.full()) models.push_back(MakeModel(100 + static_cast<std::uint32_t>(models.size()), "box"));
  return LabelsOf({models.begin(), models.end()}, 1U | 1U << (kMaxModels - 1));
}

// `count` detections of model 7; detection i has i % 5 modes. Labels of models 3 and 7.
inline FrameReport RandomReport(std::mt19937& random, std::size_t count) {
  FrameReport report;
  const ModelView models[] = {MakeModel(3, "box"), MakeModel(7, "juice_dispenser")};
  report.models = LabelsOf(models, 0b11);
  report.sequence = random();
  report.capture_time = CaptureTime(std::chrono::nanoseconds(static_cast<std::int64_t>(random() >> 1) * 1'000'000'000 +
                                                             static_cast<int>(random() % 1'000'000'000)));
  report.stamp = report.capture_time.time_since_epoch() + std::chrono::hours(2);
  for (std::size_t i = 0; i < count; ++i) {
    Detection detection;
    detection.model_id = 7;
    detection.T_camera_model = RandomPose(random);
    detection.covariance = RandomCovariance(random);
    detection.score = 0.9F - 0.05F * static_cast<float>(i);
    detection.visible_fraction = 0.5F;
    detection.track_id = static_cast<std::uint32_t>(i);
    for (std::size_t m = 0; m < i % 5; ++m) {
      detection.modes.push_back({RandomPose(random), 0.1F * static_cast<float>(m + 1)});
    }
    report.result.detections.push_back(detection);
  }
  report.result.statistics.lines = {84, 256, 3};
  report.result.budget_hit = count % 2 == 1;
  return report;
}

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_PUBLISH_REPORTS_FOR_TEST_H_
