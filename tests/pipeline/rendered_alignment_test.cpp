// The alignment of the eyes from rendered pictures: a robot drives towards a counter, with good eyes, with an eye that
// was turned since it was calibrated and with one that is exposed late.
#include <gtest/gtest.h>

#include <vector>

#include "../golden/golden_frames.h"
#include "pipeline/recognizer.h"
#include "pipeline/row_alignment.h"
#include "sim/scenario_video.h"

namespace wirepose {
namespace {

// Large, and used by one test at a time.
Recognizer& TheRecognizer() {
  static Recognizer recognizer;
  return recognizer;
}

// Thirty frames a second over joints in the floor.
std::vector<sim::StereoShot> Drive(std::uint64_t frames) {
  sim::ScenarioSpec spec;
  spec.seed = 21400;
  spec.samples = 4;
  spec.frames = static_cast<int>(frames);
  spec.camera.calibration = testing::GoldenCalibration();
  spec.camera.distance_m = {1.6, 1.8};
  spec.path.kind = sim::PathKind::kDrive;
  spec.path.speed_m_per_s = {0.4, 0.6};
  spec.path.shake_deg = {0.15, 0.3};
  const auto targets = sim::LoadTargetMeshes(WIREPOSE_MODELS);
  std::vector<sim::StereoShot> shots;
  if (!targets) return shots;
  const auto video = sim::ScenarioVideo::Create(spec, 0, *targets);
  if (!video) return shots;
  for (std::uint64_t k = 0; k < frames; ++k) shots.push_back(video->Shoot(k));
  return shots;
}

// What is said after all pairs of a left image and the right one `late` frames after it.
RowAlignment Watch(const StereoCalibration& calibration, const std::vector<sim::StereoShot>& shots, std::size_t late) {
  EXPECT_EQ(TheRecognizer().Configure(calibration), RecognizerError::kOk);
  AlignmentMonitor monitor;
  RecognitionResult result;
  for (std::size_t k = 0; k + late < shots.size(); ++k) {
    const ImageView left = shots[k].left.view(), right = shots[k + late].right.view();
    EXPECT_EQ(TheRecognizer().Process(left, right, {}, nullptr, result), RecognizerError::kOk);
    monitor.Update(TheRecognizer().camera(), TheRecognizer().row_offsets());
  }
  const RowAlignment& rows = monitor.alignment();
  printf("%u corners, median %.2f px, steady %.2f px, varying %.2f px\n", rows.corners,
         static_cast<double>(rows.median_px), static_cast<double>(rows.steady_px),
         static_cast<double>(rows.varying_px));
  return rows;
}

TEST(RenderedAlignment, LongTurnedAndLateEyesAreTold) {
  const std::vector<sim::StereoShot> shots = Drive(34);
  ASSERT_EQ(shots.size(), 34U);
  const StereoCalibration good = testing::GoldenCalibration();
  EXPECT_EQ(Watch(good, shots, 0).state, RowState::kAligned);

  StereoCalibration before = good;  // the eye has nodded by 0.15 degrees since
  before.T_right_left.R = ExpSo3({0.0026, 0, 0}) * good.T_right_left.R;
  EXPECT_EQ(Watch(before, shots, 0).state, RowState::kSteadyOffset);

  // A thirtieth of a second late. On a robot that shakes its motion changes; what of it stays may look steady.
  const RowAlignment late = Watch(good, shots, 1);
  EXPECT_TRUE(late.state == RowState::kVaryingOffset || late.state == RowState::kSteadyOffset);
  EXPECT_GT(late.varying_px, AlignmentMonitor::kLimit_px);
}

}  // namespace
}  // namespace wirepose
