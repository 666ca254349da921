// What hal/stereo_camera.h promises, asked of every backend.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "hal/replay/replay_camera.h"
#include "hal/simulated/simulated_camera.h"
#include "test_data.h"

namespace wirepose::hal {
namespace {

constexpr std::uint64_t kStreamFrames = 6;  // of the stream of every backend
constexpr auto kLong = std::chrono::seconds(30);

struct Backend {
  std::string name;
  std::function<std::unique_ptr<StereoCamera>(const std::filesystem::path& folder)> make;
  std::function<std::unique_ptr<StereoCamera>(const std::filesystem::path& folder)> make_missing;
};

Backend Replay() {
  return {"replay",
          [](const std::filesystem::path& folder) {
            test::WriteDataset(folder / "set", kStreamFrames / 2);
            ReplayConfig config;
            config.root = folder / "set";
            return std::make_unique<ReplayCamera>(config);
          },
          [](const std::filesystem::path& folder) {
            ReplayConfig config;
            config.root = folder / "nowhere";
            return std::make_unique<ReplayCamera>(config);
          }};
}

Backend PacedReplay() {
  Backend backend = Replay();
  backend.name = "paced_replay";
  backend.make = [](const std::filesystem::path& folder) {
    test::WriteDataset(folder / "set", kStreamFrames / 2);
    ReplayConfig config;
    config.root = folder / "set";
    config.frame_rate_hz = 200;
    return std::make_unique<ReplayCamera>(config);
  };
  return backend;
}

Backend Simulated() {
  return {"simulated",
          [](const std::filesystem::path& folder) {
            test::WriteBoxMesh(folder / "meshes");
            (void)dataset::WriteCalibration(folder / "calib.yaml", test::SmallCalibration());
            SimulatedConfig config;
            config.frame_count = kStreamFrames;
            config.mesh_dir = folder / "meshes";
            config.calibration_path = folder / "calib.yaml";
            config.samples_per_pixel = 4;
            return std::make_unique<SimulatedCamera>(config);
          },
          [](const std::filesystem::path& folder) {
            SimulatedConfig config;
            config.mesh_dir = folder / "nowhere";
            return std::make_unique<SimulatedCamera>(config);
          }};
}

class CameraContract : public testing::TestWithParam<Backend> {
 protected:
  CameraContract() : camera_(GetParam().make(folder_.path())) {}

  void OpenAndStart() {
    ASSERT_EQ(camera_->Open(), CameraError::kOk) << camera_->detail();
    ASSERT_EQ(camera_->Start(), CameraError::kOk) << camera_->detail();
  }

  // The stream as bytes: images and stamps of every frame.
  std::vector<std::vector<std::uint8_t>> ReadStream() {
    std::vector<std::vector<std::uint8_t>> frames;
    while (auto lease = camera_->AcquireFrame(kLong)) {
      std::vector<std::uint8_t> bytes;
      for (const ImageView& image : {(*lease)->left, (*lease)->right}) {
        for (int y = 0; y < image.height; ++y) {
          bytes.insert(bytes.end(), image.row(y), image.row(y) + image.width);
        }
      }
      for (int i = 0; i < 8; ++i) {
        bytes.push_back(static_cast<std::uint8_t>((*lease)->capture_time.time_since_epoch().count() >> (8 * i)));
      }
      frames.push_back(std::move(bytes));
    }
    return frames;
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<StereoCamera> camera_;
};

TEST_P(CameraContract, RefusesCallsThatAreNotLegal) {
  EXPECT_EQ(camera_->Start(), CameraError::kWrongState);
  EXPECT_EQ(camera_->Stop(), CameraError::kWrongState);
  EXPECT_EQ(camera_->AcquireFrame(kLong).error(), CameraError::kWrongState);
  EXPECT_EQ(camera_->Close(), CameraError::kOk) << "closing what is closed";
  ASSERT_EQ(camera_->Open(), CameraError::kOk);
  EXPECT_EQ(camera_->Open(), CameraError::kWrongState);
  EXPECT_EQ(camera_->AcquireFrame(kLong).error(), CameraError::kWrongState);
  ASSERT_EQ(camera_->Start(), CameraError::kOk);
  EXPECT_EQ(camera_->Start(), CameraError::kWrongState);
  EXPECT_EQ(camera_->Open(), CameraError::kWrongState);
  EXPECT_EQ(camera_->Close(), CameraError::kWrongState);
  EXPECT_TRUE(camera_->AcquireFrame(kLong)) << "refused calls change nothing";
  EXPECT_EQ(camera_->Stop(), CameraError::kOk);
  EXPECT_EQ(camera_->Close(), CameraError::kOk);
}

TEST_P(CameraContract, StopAndCloseAreIdempotent) {
  OpenAndStart();
  EXPECT_EQ(camera_->Stop(), CameraError::kOk);
  EXPECT_EQ(camera_->Stop(), CameraError::kOk);
  EXPECT_EQ(camera_->Close(), CameraError::kOk);
  EXPECT_EQ(camera_->Close(), CameraError::kOk);
}

TEST_P(CameraContract, CalibrationIsKnownWhenOpen) {
  ASSERT_EQ(camera_->Open(), CameraError::kOk);
  const StereoCalibration expected = test::SmallCalibration();
  EXPECT_EQ(camera_->calibration().width, expected.width);
  EXPECT_EQ(camera_->calibration().left.fx, expected.left.fx);
  EXPECT_EQ(camera_->calibration().right.k3, expected.right.k3);
  EXPECT_EQ(camera_->calibration().T_right_left.t, expected.T_right_left.t);
}

TEST_P(CameraContract, FramesAreCompleteAndInOrder) {
  OpenAndStart();
  CaptureTime last{};
  for (std::uint64_t i = 0; i < kStreamFrames; ++i) {
    const auto lease = camera_->AcquireFrame(kLong);
    ASSERT_TRUE(lease) << camera_->detail();
    const StereoFrame& frame = lease->frame();
    EXPECT_TRUE(lease->valid());
    EXPECT_EQ(frame.status, FrameStatus::kGood);
    EXPECT_EQ(camera_->detail(), "");
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.right_minus_left.count(), 0);
    EXPECT_TRUE(i == 0 || frame.capture_time > last);
    last = frame.capture_time;
    for (const ImageView& image : {frame.left, frame.right}) {
      EXPECT_EQ(image.width, test::kWidth);
      EXPECT_EQ(image.height, test::kHeight);
      EXPECT_GE(image.stride, image.width);
      ASSERT_NE(image.data, nullptr);
    }
    EXPECT_NE(frame.left.data, frame.right.data);
  }
}

TEST_P(CameraContract, StreamEndsAndSaysSo) {
  OpenAndStart();
  EXPECT_EQ(ReadStream().size(), kStreamFrames);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(camera_->AcquireFrame(kLong).error(), CameraError::kEndOfStream);
    EXPECT_NE(camera_->detail(), "");
  }
  EXPECT_EQ(camera_->Stop(), CameraError::kOk);
}

TEST_P(CameraContract, SameBytesAfterRestartAndReopen) {
  OpenAndStart();
  const auto first = ReadStream();
  ASSERT_EQ(first.size(), kStreamFrames);
  EXPECT_NE(first[0], first[1]) << "frames differ from each other";
  ASSERT_EQ(camera_->Stop(), CameraError::kOk);
  ASSERT_EQ(camera_->Start(), CameraError::kOk);
  EXPECT_TRUE(camera_->AcquireFrame(kLong));  // a stream that is left in the middle
  ASSERT_EQ(camera_->Stop(), CameraError::kOk);
  ASSERT_EQ(camera_->Start(), CameraError::kOk);
  EXPECT_EQ(ReadStream(), first);
  ASSERT_EQ(camera_->Stop(), CameraError::kOk);
  ASSERT_EQ(camera_->Close(), CameraError::kOk);
  OpenAndStart();
  EXPECT_EQ(ReadStream(), first);
}

TEST_P(CameraContract, NoBufferWhileAllAreLeased) {
  OpenAndStart();
  std::vector<FrameLease> leases;
  Result<FrameLease, CameraError> lease = camera_->AcquireFrame(kLong);
  for (; lease; lease = camera_->AcquireFrame(kLong)) leases.push_back(*std::move(lease));
  EXPECT_EQ(lease.error(), CameraError::kNoBuffer);
  EXPECT_EQ(leases.size(), 4U);
  std::vector<const std::uint8_t*> data;
  for (const FrameLease& held : leases) data.push_back(held->left.data);
  std::sort(data.begin(), data.end());
  EXPECT_EQ(std::unique(data.begin(), data.end()), data.end()) << "every lease has its own buffer";

  leases[1].Release();
  leases[1].Release();  // idempotent
  EXPECT_FALSE(leases[1].valid());
  const auto next = camera_->AcquireFrame(kLong);
  ASSERT_TRUE(next);
  EXPECT_EQ((*next)->sequence, 4U) << "no frame was lost while all buffers were leased";
}

TEST_P(CameraContract, PixelsStayUntilTheLeaseEnds) {
  OpenAndStart();
  const auto held = camera_->AcquireFrame(kLong);
  ASSERT_TRUE(held);
  const ImageView& image = (*held)->left;
  const std::vector<std::uint8_t> before(image.data, image.data + test::kWidth * test::kHeight);
  while (camera_->AcquireFrame(kLong)) {
  }
  const std::vector<std::uint8_t> after(image.data, image.data + test::kWidth * test::kHeight);
  EXPECT_EQ(before, after);
}

TEST_P(CameraContract, MovedLeaseReturnsItsBufferOnce) {
  OpenAndStart();
  auto first = camera_->AcquireFrame(kLong);
  ASSERT_TRUE(first);
  FrameLease lease = *std::move(first);
  EXPECT_TRUE(lease.valid());
  auto second = camera_->AcquireFrame(kLong);
  ASSERT_TRUE(second);
  lease = *std::move(second);  // gives the first buffer back
  EXPECT_EQ(lease->sequence, 1U);
  std::vector<FrameLease> leases;
  while (auto more = camera_->AcquireFrame(kLong)) leases.push_back(*std::move(more));
  EXPECT_EQ(leases.size(), 3U);
}

TEST_P(CameraContract, LeaseMayEndOnAnotherThread) {
  OpenAndStart();
  for (std::uint64_t i = 0; i < kStreamFrames; ++i) {
    auto lease = camera_->AcquireFrame(kLong);
    ASSERT_TRUE(lease);
    std::thread([held = *std::move(lease)]() mutable { held.Release(); }).join();
  }
}

TEST_P(CameraContract, MissingDeviceIsNamed) {
  const auto missing = GetParam().make_missing(folder_.path());
  EXPECT_EQ(missing->Open(), CameraError::kNotFound);
  EXPECT_NE(missing->detail().find("nowhere"), std::string_view::npos);
  EXPECT_EQ(missing->Start(), CameraError::kWrongState) << "it stays closed";
}

// Random legal and illegal calls against the state machine of the header.
TEST_P(CameraContract, AnyOrderOfCallsFollowsTheStateMachine) {
  enum class State { kClosed, kOpen, kStreaming };
  State state = State::kClosed;
  std::mt19937 random(5);
  for (int i = 0; i < 40; ++i) {
    const auto legal = [](bool is_legal) { return is_legal ? CameraError::kOk : CameraError::kWrongState; };
    switch (random() % 5) {
      case 0:
        ASSERT_EQ(camera_->Open(), legal(state == State::kClosed));
        if (state == State::kClosed) state = State::kOpen;
        break;
      case 1:
        ASSERT_EQ(camera_->Start(), legal(state == State::kOpen));
        if (state == State::kOpen) state = State::kStreaming;
        break;
      case 2: {
        const auto lease = camera_->AcquireFrame(kLong);
        const CameraError error = lease ? CameraError::kOk : lease.error();
        if (error == CameraError::kEndOfStream) break;
        ASSERT_EQ(error, legal(state == State::kStreaming));
        break;
      }
      case 3:
        ASSERT_EQ(camera_->Stop(), legal(state != State::kClosed));
        if (state == State::kStreaming) state = State::kOpen;
        break;
      default:
        ASSERT_EQ(camera_->Close(), legal(state != State::kStreaming));
        if (state == State::kOpen) state = State::kClosed;
        break;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, CameraContract, testing::Values(Replay(), PacedReplay(), Simulated()),
                         [](const testing::TestParamInfo<Backend>& backend) { return backend.param.name; });

}  // namespace
}  // namespace wirepose::hal
