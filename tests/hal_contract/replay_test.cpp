// What replay promises beyond the common contract.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "hal/replay/replay_camera.h"
#include "test_data.h"

namespace wirepose::hal {
namespace {

using testing::HasSubstr;

class ReplayTest : public testing::Test {
 protected:
  ReplayTest() {
    test::WriteDataset(root_, 3);
    config_.root = root_;
  }

  [[nodiscard]] std::filesystem::path Left(int frame) const {
    return root_ / "test" / "000001" / "gray_cam1" / ("00000" + std::to_string(frame) + ".png");
  }

  // The status of each frame of the stream, and why.
  struct Seen {
    FrameStatus status;
    std::string detail;
    int width;
  };
  std::vector<Seen> Play(ReplayCamera& camera) const {
    EXPECT_EQ(camera.Open(), CameraError::kOk) << camera.detail();
    EXPECT_EQ(camera.Start(), CameraError::kOk);
    std::vector<Seen> seen;
    while (auto lease = camera.AcquireFrame({})) {
      seen.push_back({(*lease)->status, std::string(camera.detail()), (*lease)->left.width});
    }
    return seen;
  }

  test::TemporaryFolder folder_;
  std::filesystem::path root_ = folder_.path() / "set";
  ReplayConfig config_;
};

TEST_F(ReplayTest, GivesTheFilesBytes) {
  ReplayCamera camera(config_);
  ASSERT_EQ(camera.Open(), CameraError::kOk);
  ASSERT_EQ(camera.Start(), CameraError::kOk);
  for (int i = 0; i < 6; ++i) {
    const auto lease = camera.AcquireFrame({});
    ASSERT_TRUE(lease);
    const std::vector<std::uint8_t> expected = test::Pattern(i, 1).pixels;
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), (*lease)->right.data));
    EXPECT_EQ(camera.Entry((*lease)->sequence).scene_id, i < 3 ? 1 : 2);
  }
}

TEST_F(ReplayTest, BadFramesAreReportedAndTheStreamGoesOn) {
  std::filesystem::remove(Left(0));
  test::WriteText(Left(1), test::ReadText(Left(1)).substr(0, 400));
  ASSERT_TRUE(dataset::WriteGrayPng(Left(2), dataset::GrayImage{8, 8, std::vector<std::uint8_t>(64)}.view()));
  ReplayCamera camera(config_);
  const std::vector<Seen> seen = Play(camera);
  ASSERT_EQ(seen.size(), 6U);
  EXPECT_EQ(seen[0].status, FrameStatus::kImageMissing);
  EXPECT_EQ(seen[0].width, 0) << "images are empty";
  EXPECT_THAT(seen[0].detail, HasSubstr("000000.png: no such image file"));
  EXPECT_EQ(seen[1].status, FrameStatus::kImageDamaged);
  EXPECT_THAT(seen[1].detail, HasSubstr("000001.png"));
  EXPECT_EQ(seen[2].status, FrameStatus::kImageDamaged);
  EXPECT_EQ(seen[2].width, test::kWidth);
  EXPECT_THAT(seen[2].detail, HasSubstr("8 x 8, calib.yaml says 160 x 120"));
  for (std::size_t i = 3; i < 6; ++i) {
    EXPECT_EQ(seen[i].status, FrameStatus::kGood);
    EXPECT_EQ(seen[i].detail, "");
  }
}

TEST_F(ReplayTest, OneSceneOnly) {
  config_.scene_id = 2;
  ReplayCamera camera(config_);
  EXPECT_EQ(Play(camera).size(), 3U);
  config_.scene_id = 7;
  ReplayCamera nothing(config_);
  EXPECT_EQ(nothing.Open(), CameraError::kNotFound);
  EXPECT_THAT(std::string(nothing.detail()), HasSubstr("scene 7"));
}

TEST_F(ReplayTest, LoopsWithRisingSequence) {
  config_.loop = true;
  ReplayCamera camera(config_);
  ASSERT_EQ(camera.Open(), CameraError::kOk);
  ASSERT_EQ(camera.Start(), CameraError::kOk);
  for (std::uint64_t i = 0; i < 15; ++i) {
    const auto lease = camera.AcquireFrame({});
    ASSERT_TRUE(lease);
    EXPECT_EQ((*lease)->sequence, i);
    EXPECT_EQ((*lease)->left(5, 5), test::Pattern(static_cast<int>(i % 6), 0).view()(5, 5));
  }
}

TEST_F(ReplayTest, CaptureTimesFollowTheFrameRate) {
  config_.frame_rate_hz = 500;
  ReplayCamera camera(config_);
  ASSERT_EQ(camera.Open(), CameraError::kOk);
  ASSERT_EQ(camera.Start(), CameraError::kOk);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 6; ++i) {
    const auto lease = camera.AcquireFrame(std::chrono::seconds(10));
    ASSERT_TRUE(lease);
    EXPECT_EQ((*lease)->capture_time.time_since_epoch(), std::chrono::milliseconds(2 * i));
  }
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(9));
}

TEST_F(ReplayTest, TimesOutBeforeAFrameIsDue) {
  config_.frame_rate_hz = 1;
  ReplayCamera camera(config_);
  ASSERT_EQ(camera.Open(), CameraError::kOk);
  ASSERT_EQ(camera.Start(), CameraError::kOk);
  ASSERT_TRUE(camera.AcquireFrame({}));
  EXPECT_EQ(camera.AcquireFrame(std::chrono::milliseconds(1)).error(), CameraError::kTimeout);
}

TEST_F(ReplayTest, RefusesAFrameRateOutOfRange) {
  for (const double rate : {-1.0, 1001.0, std::nan("")}) {
    config_.frame_rate_hz = rate;
    ReplayCamera camera(config_);
    EXPECT_EQ(camera.Open(), CameraError::kUnsupported);
    EXPECT_THAT(std::string(camera.detail()), HasSubstr("frame rate"));
  }
}

TEST_F(ReplayTest, MalformedDataIsNamed) {
  test::WriteText(root_ / "calib.yaml", "%YAML:1.0\n---\nK1: 3\n");
  ReplayCamera camera(config_);
  EXPECT_EQ(camera.Open(), CameraError::kBadData);
  EXPECT_THAT(std::string(camera.detail()), HasSubstr("calib.yaml"));
}

TEST_F(ReplayTest, ADataSetOfOneCameraIsRefusedWithTheReason) {
  std::filesystem::remove(root_ / "calib.yaml");
  test::WriteText(root_ / "test/000001/scene_camera.json", "{}");
  ReplayCamera camera(config_);
  EXPECT_EQ(camera.Open(), CameraError::kBadData);
  EXPECT_THAT(std::string(camera.detail()), HasSubstr("one camera with depth"));
}

}  // namespace
}  // namespace wirepose::hal
