// Rendered drives of a robot whose right eye is good, late or turned: what the recognizer's corners and the estimate
// over frames make of the pictures.
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <numbers>

#include "pipeline/recognizer.h"
#include "pipeline/row_alignment.h"
#include "sim/scenario_video.h"

namespace wirepose {
namespace {

class EyesTest : public ::testing::Test {
 protected:
  // A robot that rolls towards a counter, over joints in the floor unless `shake_deg` is 0.
  static sim::ScenarioSpec Drive(std::uint64_t seed, double shake_deg) {
    sim::ScenarioSpec spec;
    spec.seed = seed;
    spec.rate_hz = 10;
    spec.samples = 4;
    StereoCalibration& rig = spec.camera.calibration;
    rig = {};
    rig.width = 320;
    rig.height = 240;
    rig.left.fx = rig.left.fy = rig.right.fx = rig.right.fy = 262.5;
    rig.left.cx = rig.right.cx = 159.5;
    rig.left.cy = rig.right.cy = 119.5;
    rig.T_right_left.t = {-0.12, 0, 0};
    spec.clutter.count = {6, 8};
    spec.path.kind = sim::PathKind::kDrive;
    spec.path.speed_m_per_s = {0.4, 0.5};
    spec.path.shake_deg = {shake_deg, shake_deg};
    return spec;
  }

  // Each of `frames` pictures is shown three times, so that few have to be rendered.
  RowAlignment Watch(const sim::ScenarioSpec& spec, const sim::ShotChange& change, int frames) {
    const auto targets = sim::LoadTargetMeshes(WIREPOSE_MODELS);
    EXPECT_TRUE(targets) << targets.error();
    const auto video = sim::ScenarioVideo::Create(spec, 0, *targets);
    EXPECT_TRUE(video) << video.error();
    EXPECT_EQ(recognizer_->Configure(video->calibration()), RecognizerError::kOk);
    AlignmentMonitor monitor;
    RecognitionResult result;
    double corners = 0;
    for (int i = 0; i < frames; ++i) {
      const sim::StereoShot shot = video->Shoot(static_cast<std::uint64_t>(i), change);
      EXPECT_EQ(recognizer_->Process(shot.left.view(), shot.right.view(), nullptr, result), RecognizerError::kOk);
      for (int k = 0; k < 3; ++k) monitor.Update(recognizer_->camera(), recognizer_->row_offsets());
      corners += static_cast<double>(monitor.alignment().corners) / frames;
    }
    const RowAlignment& rows = monitor.alignment();
    std::printf("lag %.0f ms, drift %.2f deg: %.1f corners, steady %.3f px, varying %.3f px\n",
                1e3 * change.right_lag_s, change.drift_rad * 180 / std::numbers::pi, corners,
                static_cast<double>(rows.steady_px), static_cast<double>(rows.varying_px));
    return rows;
  }

  std::unique_ptr<Recognizer> recognizer_ = std::make_unique<Recognizer>();
};

constexpr int kFrames = 14;

TEST_F(EyesTest, GoodEyesAreAligned) { EXPECT_EQ(Watch(Drive(31, 0.3), {}, kFrames).state, RowState::kAligned); }

TEST_F(EyesTest, LateEyeShowsWhileTheRobotShakes) {
  EXPECT_EQ(Watch(Drive(31, 0.3), {.right_lag_s = 0.03}, kFrames).state, RowState::kVaryingOffset);
}

TEST_F(EyesTest, TurnedEyeIsSteadilyOff) {
  EXPECT_EQ(Watch(Drive(31, 0.3), {.drift_rad = 1.2 * std::numbers::pi / 180}, kFrames).state, RowState::kSteadyOffset);
}

// More scenes: no false alarm, and how small a lag still shows.
TEST_F(EyesTest, LongDrives) {
  for (const std::uint64_t seed : {41U, 42U, 43U}) {
    SCOPED_TRACE(seed);
    EXPECT_EQ(Watch(Drive(seed, 0.3), {}, 20).state, RowState::kAligned);
    EXPECT_EQ(Watch(Drive(seed, 0), {}, 20).state, RowState::kAligned);
    EXPECT_EQ(Watch(Drive(seed, 0.3), {.right_lag_s = 0.001}, 20).state, RowState::kAligned) << "too small to matter";
    EXPECT_EQ(Watch(Drive(seed, 0.3), {.right_lag_s = 0.02}, 20).state, RowState::kVaryingOffset);
    EXPECT_EQ(Watch(Drive(seed, 0.3), {.right_lag_s = 0.04}, 20).state, RowState::kVaryingOffset);
  }
}

}  // namespace
}  // namespace wirepose
