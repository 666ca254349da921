// Faults of the simulated feed, one by one, as a scenario file orders them.
#include "hal/simulated/feed_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>

#include "hal/simulated/simulated_camera.h"
#include "test_data.h"

namespace wirepose::hal {
namespace {

using sim::FaultKind;
using testing::HasSubstr;

// What one AcquireFrame gave.
struct Seen {
  CameraError error = CameraError::kOk;
  StereoFrame frame;
  std::vector<std::uint8_t> left, right;
};

class FeedFaults : public testing::Test {
 protected:
  FeedFaults() {
    test::WriteBoxMesh(folder_.path() / "meshes");
    (void)dataset::WriteCalibration(folder_.path() / "calib.yaml", test::SmallCalibration());
  }

  SimulatedConfig Config(const std::string& feed) const {
    std::ofstream(folder_.path() / "scenario.yaml")
        << "rate_hz: 10\nsamples: 4\nroom: { kind: studio }\nobjects: [ { model: parcel_box, visible: [0, 1] } ]\n"
        << "clutter: { count: 0 }\npath: { kind: orbit, speed_m_per_s: 0.6 }\nfeed:\n"
        << feed;
    SimulatedConfig config;
    config.scenario_path = folder_.path() / "scenario.yaml";
    config.frame_count = 5;
    config.mesh_dir = folder_.path() / "meshes";
    config.calibration_path = folder_.path() / "calib.yaml";
    return config;
  }

  // The whole stream.
  static std::vector<Seen> Play(const SimulatedConfig& config) {
    SimulatedCamera camera(config);
    EXPECT_EQ(camera.Open(), CameraError::kOk) << camera.detail();
    EXPECT_EQ(camera.Start(), CameraError::kOk);
    std::vector<Seen> stream;
    while (true) {
      const auto lease = camera.AcquireFrame(std::chrono::seconds(60));
      if (!lease && lease.error() == CameraError::kEndOfStream) break;
      Seen seen;
      if (!lease) {
        seen.error = lease.error();
      } else {
        seen.frame = lease->frame();
        const auto size = static_cast<std::size_t>(seen.frame.left.width * seen.frame.left.height);
        seen.left.assign(seen.frame.left.data, seen.frame.left.data + size);
        seen.right.assign(seen.frame.right.data, seen.frame.right.data + size);
      }
      EXPECT_TRUE(lease || seen.error == CameraError::kDisconnected) << camera.detail();
      if (!lease && seen.error != CameraError::kDisconnected) break;
      stream.push_back(seen);
    }
    return stream;
  }

  std::vector<Seen> Play(const std::string& fault) const { return Play(Config("  faults: [ " + fault + " ]\n")); }
  const std::vector<Seen>& Good() {
    if (good_.empty()) good_ = Play(Config("  stamp_jitter_us: 0\n"));
    return good_;
  }

  test::TemporaryFolder folder_;
  std::vector<Seen> good_;
};

TEST_F(FeedFaults, DroppedFrameLeavesAGap) {
  const auto stream = Play("{ fault: drop, at: 2 }");
  ASSERT_EQ(stream.size(), 4U);
  EXPECT_EQ(stream[2].frame.sequence, 3U);
  EXPECT_EQ(stream[2].left, Good()[3].left);
}

TEST_F(FeedFaults, DuplicateAndFreezeRepeatImagesWithNewStamps) {
  const auto stream = Play("{ fault: freeze, at: 2, frames: 2 }");
  ASSERT_EQ(stream.size(), 5U);
  EXPECT_EQ(stream[2].left, Good()[1].left);
  EXPECT_EQ(stream[3].right, Good()[1].right);
  EXPECT_EQ(stream[4].left, Good()[4].left);
  EXPECT_EQ(stream[3].frame.capture_time, Good()[3].frame.capture_time);
  EXPECT_EQ(Play("{ fault: duplicate, at: 1 }")[1].left, Good()[0].left);
}

TEST_F(FeedFaults, SwapTearAndBitFlipChangeThePixels) {
  const auto swapped = Play("{ fault: swap, at: 1 }");
  EXPECT_EQ(swapped[1].left, Good()[1].right);
  EXPECT_EQ(swapped[1].right, Good()[1].left);
  EXPECT_EQ(swapped[2].left, Good()[2].left);

  const auto torn = Play("{ fault: tear, at: 3 }");
  EXPECT_EQ(torn[3].left.front(), Good()[3].left.front());
  const std::size_t lower = torn[3].left.size() * 3 / 5 + 200;
  EXPECT_TRUE(std::equal(torn[3].left.begin() + static_cast<std::ptrdiff_t>(lower), torn[3].left.end(),
                         Good()[2].left.begin() + static_cast<std::ptrdiff_t>(lower)));
  EXPECT_NE(torn[3].left, Good()[2].left);

  const auto flipped = Play("{ fault: bit_flip, at: 1, amount: 0.01 }");
  std::size_t changed = 0;
  for (std::size_t i = 0; i < flipped[1].left.size(); ++i) changed += flipped[1].left[i] != Good()[1].left[i] ? 1 : 0;
  const double share = static_cast<double>(changed) / static_cast<double>(flipped[1].left.size());
  EXPECT_NEAR(share, 0.01, 0.005);
}

TEST_F(FeedFaults, OffsetMovesTheRightEyeOnlyAndSaysSo) {
  const auto stream = Play("{ fault: offset, at: 2, amount: 40 }");
  EXPECT_EQ(stream[2].frame.status, FrameStatus::kNotSynchronous);
  EXPECT_EQ(stream[2].frame.right_minus_left, std::chrono::milliseconds(40));
  EXPECT_EQ(stream[2].left, Good()[2].left);
  EXPECT_NE(stream[2].right, Good()[2].right);
  EXPECT_EQ(stream[3].frame.status, FrameStatus::kGood);
}

TEST_F(FeedFaults, HiddenOffsetIsTheSameWithoutAWord) {
  const auto stream = Play("{ fault: hidden_offset, at: 2, amount: 40 }");
  EXPECT_EQ(stream[2].frame.status, FrameStatus::kGood);
  EXPECT_EQ(stream[2].frame.right_minus_left, std::chrono::nanoseconds(0));
  EXPECT_EQ(stream[2].right, Play("{ fault: offset, at: 2, amount: 40 }")[2].right);
}

TEST_F(FeedFaults, ExposureSmearCoverAndDriftShow) {
  const auto mean = [](const std::vector<std::uint8_t>& pixels) {
    double sum = 0;
    for (const std::uint8_t p : pixels) sum += p;
    return sum / static_cast<double>(pixels.size());
  };
  EXPECT_LT(mean(Play("{ fault: exposure, at: 1, amount: 0.3 }")[1].left), 0.75 * mean(Good()[1].left));
  const auto smeared = Play("{ fault: smear, at: 1 }");
  EXPECT_NE(smeared[1].left, Good()[1].left);
  EXPECT_EQ(smeared[1].right, Good()[1].right);
  EXPECT_LT(mean(Play("{ fault: cover, at: 1 }")[1].left), 0.6 * mean(Good()[1].left));
  const auto drifted = Play("{ fault: drift, at: 1, frames: 3, amount: 0.5 }");
  EXPECT_EQ(drifted[1].left, Good()[1].left);
  EXPECT_NE(drifted[1].right, Good()[1].right);
}

TEST_F(FeedFaults, DisconnectedDeviceReturns) {
  const auto stream = Play("{ fault: disconnect, at: 1, frames: 2 }");
  ASSERT_EQ(stream.size(), 5U);
  EXPECT_EQ(stream[1].error, CameraError::kDisconnected);
  EXPECT_EQ(stream[2].error, CameraError::kDisconnected);
  EXPECT_EQ(stream[3].error, CameraError::kOk);
  EXPECT_EQ(stream[3].frame.sequence, 3U);
  EXPECT_EQ(stream[3].left, Good()[3].left);
}

TEST_F(FeedFaults, ClockStepsAndStays) {
  const auto stream = Play("{ fault: clock_step, at: 2, amount: -500 }");
  EXPECT_EQ(stream[1].frame.capture_time, Good()[1].frame.capture_time);
  for (const std::size_t i : {2U, 4U}) {
    EXPECT_EQ(Good()[i].frame.capture_time - stream[i].frame.capture_time, std::chrono::milliseconds(500));
  }
}

TEST_F(FeedFaults, JitterHasTheSpreadAskedFor) {
  sim::FeedSpec feed;
  feed.stamp_jitter_us = 50;
  double square = 0;
  constexpr int kFrames = 4000;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const double lag_us = 1e6 * PlanFrame(feed, i, 7).change.right_lag_s;
    square += lag_us * lag_us / kFrames;
  }
  EXPECT_NEAR(std::sqrt(square), 50, 3);
}

// The second time the frames come from disk: the same bytes, at the rate of the scenario.
TEST_F(FeedFaults, CacheGivesTheSameBytesAtTheScenariosRate) {
  SimulatedConfig config = Config("  stamp_jitter_us: 0\n");
  config.cache_path = folder_.path() / "cache";
  const auto first = Play(config);
  ASSERT_EQ(first.size(), 5U);
  const auto start = std::chrono::steady_clock::now();
  const auto second = Play(config);
  const auto took = std::chrono::steady_clock::now() - start;
  ASSERT_EQ(second.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(second[i].left, Good()[i].left);
    EXPECT_EQ(second[i].right, first[i].right);
    EXPECT_EQ(second[i].frame.capture_time, first[i].frame.capture_time);
  }
  EXPECT_GE(took, std::chrono::milliseconds(400)) << "five frames at 10 Hz end 0.4 s after the first";
}

// Two frames over and over, at the scenario's rate, with numbers and stamps that go on; faults still happen.
TEST_F(FeedFaults, LoopRepeatsImagesAndKeepsCounting) {
  SimulatedConfig config = Config("  faults: [ { fault: swap, at: 3 }, { fault: exposure, at: 4, amount: 0.3 } ]\n");
  config.loop_frames = 2;
  config.frame_count = 7;
  const auto start = std::chrono::steady_clock::now();
  const auto stream = Play(config);
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(600)) << "seven frames at 10 Hz";
  ASSERT_EQ(stream.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(stream[i].frame.sequence, i);
    EXPECT_EQ(stream[i].frame.capture_time.time_since_epoch(), std::chrono::milliseconds(100 * i));
    if (i == 3 || i == 4) continue;  // a fault each
    EXPECT_EQ(stream[i].left, Good()[i % 2].left) << i;
  }
  EXPECT_EQ(stream[3].left, Good()[1].right);
  EXPECT_NE(stream[4].left, Good()[0].left);
  config.loop_frames = SimulatedCamera::kMaxLoopFrames + 1;
  SimulatedCamera camera(config);
  EXPECT_EQ(camera.Open(), CameraError::kUnsupported);
  EXPECT_THAT(std::string(camera.detail()), HasSubstr("1001"));
}

}  // namespace
}  // namespace wirepose::hal
