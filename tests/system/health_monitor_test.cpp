#include "app/health_monitor.h"

#include <gtest/gtest.h>

#include <limits>

namespace wirepose::app {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const HealthMonitor::Clock::time_point kStart{};

hal::StereoFrame Frame(std::uint64_t sequence, hal::FrameStatus status = hal::FrameStatus::kGood) {
  hal::StereoFrame frame;
  frame.sequence = sequence;
  frame.status = status;
  return frame;
}

TEST(HealthMonitor, BeginsDueAndStarting) {
  HealthMonitor health("replay", kStart);
  EXPECT_TRUE(health.Due(kStart));
  const HealthReport& report = health.Report(kStart + seconds(2));
  EXPECT_EQ(report.state, HealthState::kStarting);
  EXPECT_EQ(report.uptime_ns, 2'000'000'000u);
  EXPECT_TRUE(report.camera == "replay");
  EXPECT_TRUE(report.camera_status == "ok");
}

TEST(HealthMonitor, DueOnceASecondAndOnChange) {
  HealthMonitor health("replay", kStart);
  health.Sent(kStart);
  EXPECT_FALSE(health.Due(kStart + milliseconds(999)));
  EXPECT_TRUE(health.Due(kStart + seconds(1)));
  health.FrameDone({});
  EXPECT_TRUE(health.Due(kStart + milliseconds(1))) << "starting -> running";
  health.Sent(kStart + milliseconds(1));
  health.FrameDone({});
  EXPECT_FALSE(health.Due(kStart + milliseconds(2)));
  health.CameraFailed(hal::CameraError::kDisconnected, "");
  EXPECT_TRUE(health.Due(kStart + milliseconds(3)));
  health.Sent(kStart + milliseconds(3));
  health.CameraFailed(hal::CameraError::kNoBuffer, "");
  EXPECT_TRUE(health.Due(kStart + milliseconds(4))) << "same state, another reason";
}

TEST(HealthMonitor, CountsEveryKindOfFrame) {
  HealthMonitor health("replay", kStart);
  health.FrameArrived(Frame(0), "");
  health.FrameDone({});
  health.FrameArrived(Frame(1, hal::FrameStatus::kImageMissing), "");
  health.FrameArrived(Frame(2, hal::FrameStatus::kImageDamaged), "x.png: truncated");
  health.FrameArrived(Frame(6, hal::FrameStatus::kNotSynchronous), "");
  health.FrameArrived(Frame(7), "");
  health.FrameFailed(7, "the image is not of the calibrated size");
  const HealthReport& report = health.Report(kStart);
  EXPECT_EQ(report.frames.good, 1u);
  EXPECT_EQ(report.frames.missing, 1u);
  EXPECT_EQ(report.frames.damaged, 1u);
  EXPECT_EQ(report.frames.not_synchronous, 1u);
  EXPECT_EQ(report.frames.late, 3u) << "3, 4 and 5 never came";
  EXPECT_EQ(report.frames.failed, 1u);
  EXPECT_EQ(report.state, HealthState::kBadFrames);
  EXPECT_TRUE(report.last_error == "frame 7: the image is not of the calibrated size");
}

TEST(HealthMonitor, AGoodFrameEndsTroubleButNotItsMemory) {
  HealthMonitor health("replay", kStart);
  health.FrameArrived(Frame(2, hal::FrameStatus::kImageDamaged), "x.png: truncated");
  EXPECT_EQ(health.Report(kStart).state, HealthState::kBadFrames);
  EXPECT_TRUE(health.Report(kStart).camera_status == "image damaged");
  health.FrameArrived(Frame(3), "");
  health.FrameDone({});
  EXPECT_EQ(health.Report(kStart).state, HealthState::kRunning);
  EXPECT_TRUE(health.Report(kStart).camera_status == "ok");
  EXPECT_TRUE(health.Report(kStart).last_error == "frame 2: image damaged: x.png: truncated");
}

TEST(HealthMonitor, TellsSilenceFromLoss) {
  HealthMonitor health("replay", kStart);
  health.CameraFailed(hal::CameraError::kTimeout, "");
  EXPECT_EQ(health.Report(kStart).state, HealthState::kNoFrames);
  health.CameraFailed(hal::CameraError::kDisconnected, "usb 1-2");
  EXPECT_EQ(health.Report(kStart).state, HealthState::kCameraLost);
  EXPECT_TRUE(health.Report(kStart).last_error == "camera disconnected: usb 1-2");
  health.Stopped();
  EXPECT_EQ(health.Report(kStart).state, HealthState::kStopped);
  EXPECT_TRUE(health.Report(kStart).camera_status == "camera disconnected");
}

TEST(HealthMonitor, TellsWhatTheFramesSayOfTheEyes) {
  HealthMonitor health("replay", kStart);
  EXPECT_EQ(health.Report(kStart).rows.state, RowState::kUnknown);
  health.RowsMeasured({RowState::kVaryingOffset, 12, 0.5F, 0.25F, 0.125F, 0.75F});
  EXPECT_EQ(health.Report(kStart).rows.state, RowState::kVaryingOffset);
  EXPECT_EQ(health.Report(kStart).rows.varying_px, 0.75F);
}

TEST(HealthMonitor, KeepsHighWaterAndSumOfDrops) {
  HealthMonitor health("replay", kStart);
  RecognitionStatistics statistics;
  statistics.lines = {80, 256, 1};
  health.FrameDone(statistics);
  statistics.lines = {50, 256, std::numeric_limits<std::uint32_t>::max() - 3};
  health.FrameDone(statistics);
  EXPECT_EQ(health.Report(kStart).lists.lines.used, 80u);
  EXPECT_EQ(health.Report(kStart).lists.lines.capacity, 256u);
  EXPECT_EQ(health.Report(kStart).lists.lines.dropped, std::numeric_limits<std::uint32_t>::max() - 2);
  health.FrameDone(statistics);
  EXPECT_EQ(health.Report(kStart).lists.lines.dropped, std::numeric_limits<std::uint32_t>::max()) << "wrapped";
}

}  // namespace
}  // namespace wirepose::app
