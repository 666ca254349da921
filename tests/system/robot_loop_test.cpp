// The loop on a camera that follows a script of good frames and trouble.
#include "app/robot_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <thread>
#include <variant>
#include <vector>

#include "../dds_domain.h"
#include "app/failure.h"

namespace wirepose::app {
namespace {

using hal::CameraError;
using hal::FrameStatus;

constexpr int kWidth = 160;
constexpr int kHeight = 120;

class ScriptedCamera final : public hal::StereoCamera {
 public:
  using Step = std::variant<FrameStatus, CameraError>;
  // After the last step the feed is over.
  explicit ScriptedCamera(std::deque<Step> script) : script_(std::move(script)) {}

  int leased = 0;

 private:
  CameraError DoOpen(StereoCalibration& calibration) override {
    calibration.left = calibration.right = {150, 150, 79.5, 59.5, 0, 0, 0, 0, 0};
    calibration.T_right_left.t = {-0.1, 0, 0};
    calibration.width = kWidth;
    calibration.height = kHeight;
    return CameraError::kOk;
  }
  CameraError DoStart() override { return CameraError::kOk; }
  Result<Captured, CameraError> DoAcquire(std::chrono::nanoseconds) override {
    // Slow enough for a subscriber of keep-last 1 to see every state.
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    if (script_.empty()) return unexpected(CameraError::kEndOfStream);
    const Step step = script_.front();
    script_.pop_front();
    if (const auto* const error = std::get_if<CameraError>(&step)) return unexpected(*error);
    Captured captured;
    captured.frame.status = std::get<FrameStatus>(step);
    captured.frame.sequence = sequence_++;
    captured.frame.left = captured.frame.right = {pixels_.data(), kWidth, kHeight, kWidth};
    ++leased;
    return captured;
  }
  void DoRelease(std::uint32_t) override { --leased; }
  CameraError DoStop() override { return CameraError::kOk; }
  void DoClose() override {}
  [[nodiscard]] std::string_view DoDetail() const override { return "script"; }
  [[nodiscard]] std::string_view DoName() const override { return "scripted"; }

  std::deque<Step> script_;
  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(std::size_t{kWidth} * kHeight, 100);
  std::uint64_t sequence_ = 0;
};

class RobotLoopTest : public ::testing::Test {
 protected:
  // Runs the loop on the script and gathers the health messages.
  void Run(std::deque<ScriptedCamera::Step> script, std::uint64_t max_frames = 0) {
    camera_ = std::make_unique<ScriptedCamera>(std::move(script));
    ASSERT_EQ(camera_->Open(), CameraError::kOk);
    ASSERT_EQ(recognizer_->Configure(camera_->calibration()), RecognizerError::kOk);
    BusConfig bus;
    bus.domain = domain_.id();
    bus.loopback = true;
    const auto opened = publisher_->Open({bus, "eye", "1"});
    ASSERT_TRUE(opened) << opened.error();
    ASSERT_EQ(camera_->Start(), CameraError::kOk);
    const Result<Bus, std::string> reader_bus = Bus::Open(bus);
    ASSERT_TRUE(reader_bus) << reader_bus.error();
    const Result<dds_entity_t, std::string> reader = reader_bus->CreateReader(TopicId::kHealth);
    ASSERT_TRUE(reader) << reader.error();
    WaitForMatch(*reader);

    std::atomic<bool> done{false};
    std::thread listener([&] { Listen(*reader, done); });
    Service service;
    CommandHandler commands(*recognizer_, *models_, kWidth, kHeight);
    const auto loop = std::make_unique<RobotLoop>(RobotParts{*camera_, *recognizer_, *publisher_, commands, service},
                                                  RobotLoopConfig{timeout_, max_frames});
    try {
      loop->Run(stop_);
    } catch (const WorkFailed& e) {
      failure_ = e.what();
    }
    frames_ = loop->frames();
    dds_sleepfor(DDS_MSECS(200));
    done = true;
    listener.join();
  }

  static void WaitForMatch(dds_entity_t reader) {
    dds_subscription_matched_status_t status{};
    for (int i = 0; i < 500 && status.current_count == 0; ++i) {
      dds_sleepfor(DDS_MSECS(10));
      dds_get_subscription_matched_status(reader, &status);
    }
    ASSERT_GT(status.current_count, 0u);
  }

  void Listen(dds_entity_t reader, const std::atomic<bool>& done) {
    const auto message = std::make_unique<HealthMessage>();
    void* samples[] = {&message->value};
    dds_sample_info_t info{};
    while (!done) {
      while (dds_take(reader, samples, &info, 1, 1) > 0) {
        if (!info.valid_data) continue;
        if (states_.empty() || states_.back() != message->value.state) states_.push_back(message->value.state);
        good_ = message->value.frames.good;
        damaged_ = message->value.frames.damaged;
      }
      dds_sleepfor(DDS_MSECS(2));
    }
  }

  test::DdsDomain domain_;
  std::unique_ptr<ScriptedCamera> camera_;
  std::unique_ptr<Recognizer> recognizer_ = std::make_unique<Recognizer>();
  std::unique_ptr<ModelLibrary> models_ = std::make_unique<ModelLibrary>(*recognizer_);
  std::unique_ptr<Publisher> publisher_ = std::make_unique<Publisher>();
  std::atomic<bool> stop_{false};
  std::chrono::milliseconds timeout_{50};
  std::vector<wirepose_HealthState> states_;
  std::uint64_t good_ = 0, damaged_ = 0, frames_ = 0;
  std::string failure_;
};

TEST_F(RobotLoopTest, GoesOnThroughEveryKindOfTrouble) {
  Run({FrameStatus::kGood, CameraError::kTimeout, FrameStatus::kGood, FrameStatus::kImageDamaged, FrameStatus::kGood,
       CameraError::kDisconnected, CameraError::kDisconnected, FrameStatus::kGood});
  EXPECT_EQ(failure_, "");
  EXPECT_EQ(frames_, 5u);
  EXPECT_EQ(good_, 4u);
  EXPECT_EQ(damaged_, 1u);
  ASSERT_FALSE(states_.empty());
  if (states_.front() == wirepose_STARTING) states_.erase(states_.begin());  // may precede the match
  EXPECT_EQ(states_, (std::vector{wirepose_RUNNING, wirepose_NO_FRAMES, wirepose_RUNNING, wirepose_BAD_FRAMES,
                                  wirepose_RUNNING, wirepose_CAMERA_LOST, wirepose_RUNNING, wirepose_STOPPED}));
  EXPECT_EQ(camera_->leased, 0);
}

TEST_F(RobotLoopTest, SilenceCountsOnlyAfterTheTimeout) {
  timeout_ = std::chrono::seconds(20);
  Run({FrameStatus::kGood, CameraError::kTimeout, CameraError::kTimeout, FrameStatus::kGood});
  EXPECT_EQ(std::count(states_.begin(), states_.end(), wirepose_NO_FRAMES), 0);
  EXPECT_EQ(good_, 2u);
}

TEST_F(RobotLoopTest, EndsOnWhatWaitingCannotMend) {
  Run({FrameStatus::kGood, CameraError::kBadData, FrameStatus::kGood});
  EXPECT_EQ(failure_, "script");
  EXPECT_EQ(frames_, 1u);
  ASSERT_FALSE(states_.empty());
  EXPECT_EQ(states_.back(), wirepose_CAMERA_LOST);
}

TEST_F(RobotLoopTest, EndsAfterTheFramesAskedFor) {
  Run(std::deque<ScriptedCamera::Step>(10, FrameStatus::kGood), 3);
  EXPECT_EQ(frames_, 3u);
  EXPECT_EQ(states_.back(), wirepose_STOPPED);
}

TEST_F(RobotLoopTest, EndsAtOnceWhenAskedToStop) {
  stop_ = true;
  Run(std::deque<ScriptedCamera::Step>(10, FrameStatus::kGood));
  EXPECT_EQ(frames_, 0u);
  EXPECT_EQ(states_.back(), wirepose_STOPPED);
}

}  // namespace
}  // namespace wirepose::app
