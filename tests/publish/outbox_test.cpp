#include "publish/outbox.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <thread>

namespace wirepose {
namespace {

FrameReport Numbered(std::uint64_t sequence) {
  FrameReport report;
  report.sequence = sequence;
  return report;
}

class OutboxTest : public ::testing::Test {
 protected:
  // Sequence number of the next report, and what the outbox says was dropped before it.
  std::uint64_t TakeNext() {
    const FrameReport* const report = outbox_->TakeFrame(dropped_);
    if (report == nullptr) return 0;
    const std::uint64_t sequence = report->sequence;
    outbox_->Release(report);
    return sequence;
  }

  std::unique_ptr<Outbox> outbox_ = std::make_unique<Outbox>();
  std::uint64_t dropped_ = 0;
};

TEST_F(OutboxTest, GivesReportsInOrder) {
  EXPECT_EQ(TakeNext(), 0u);
  outbox_->Offer(Numbered(1));
  outbox_->Offer(Numbered(2));
  EXPECT_EQ(TakeNext(), 1u);
  EXPECT_EQ(TakeNext(), 2u);
  EXPECT_EQ(TakeNext(), 0u);
  EXPECT_EQ(dropped_, 0u);
}

// A publisher that never takes anything: the vision thread goes on, and the newest wait.
TEST_F(OutboxTest, StalledConsumerGetsTheNewestOnceItIsBack) {
  for (std::uint64_t i = 1; i <= 100; ++i) outbox_->Offer(Numbered(i));
  EXPECT_EQ(outbox_->dropped(), 100 - Outbox::kFrames);
  for (std::uint64_t i = 101 - Outbox::kFrames; i <= 100; ++i) {
    EXPECT_EQ(TakeNext(), i);
    EXPECT_EQ(dropped_, 100 - Outbox::kFrames) << "all losses came before these";
  }
  outbox_->Offer(Numbered(101));
  EXPECT_EQ(TakeNext(), 101u);
  EXPECT_EQ(dropped_, 100 - Outbox::kFrames);
  EXPECT_EQ(outbox_->high_water(), outbox_->capacity());
}

TEST_F(OutboxTest, ReportBeingWrittenStaysWhatItIs) {
  outbox_->Offer(Numbered(1));
  const FrameReport* const writing = outbox_->TakeFrame(dropped_);
  for (std::uint64_t i = 2; i <= 50; ++i) {
    outbox_->Offer(Numbered(i));
    ASSERT_EQ(writing->sequence, 1u) << "overwritten while being written";
  }
  outbox_->Release(writing);
  EXPECT_EQ(TakeNext(), 51 - Outbox::kFrames);
}

TEST_F(OutboxTest, EveryKindGoesItsOwnWay) {
  for (std::uint64_t i = 1; i <= 20; ++i) outbox_->Offer(Numbered(i));
  HealthReport health;
  SceneReport scene;
  for (std::uint64_t i = 1; i <= 3; ++i) {
    health.uptime_ns = i;
    outbox_->Offer(health);
    scene.dropped = static_cast<std::uint32_t>(i);
    outbox_->Offer(scene);
  }
  CommandAnswer answer;
  for (std::uint64_t i = 1; i <= Outbox::kAnswers; ++i) {
    answer.command.request_id = i;
    EXPECT_TRUE(outbox_->Offer(answer));
  }
  EXPECT_FALSE(outbox_->Offer(answer)) << "an answer is never given up for another";

  const HealthReport* const newest = outbox_->TakeHealth();
  ASSERT_NE(newest, nullptr);
  EXPECT_EQ(newest->uptime_ns, 3u);
  outbox_->Release(newest);
  EXPECT_EQ(outbox_->TakeHealth(), nullptr);
  const SceneReport* const seen = outbox_->TakeScene();
  ASSERT_NE(seen, nullptr);
  EXPECT_EQ(seen->dropped, 3u);
  outbox_->Release(seen);
  for (std::uint64_t i = 1; i <= Outbox::kAnswers; ++i) {
    ASSERT_TRUE(outbox_->TakeAnswer(answer));
    EXPECT_EQ(answer.command.request_id, i);
  }
  EXPECT_FALSE(outbox_->TakeAnswer(answer));
}

// The taker pauses at random; every report is either taken, in order and whole, or counted as given up.
TEST_F(OutboxTest, TwoThreadsLoseNothingUncounted) {
  constexpr std::uint64_t kReports = 20000;
  std::atomic<bool> done{false};
  std::uint64_t taken = 0, disorder = 0, torn = 0, miscounted = 0;
  std::thread consumer([&] {
    std::mt19937 random(5);
    std::uint64_t last = 0;
    for (;;) {
      const bool last_round = done;
      while (const FrameReport* const report = outbox_->TakeFrame(dropped_)) {
        disorder += report->sequence <= last ? 1 : 0;
        last = report->sequence;
        if (random() % 64 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
        torn += report->capture_time.time_since_epoch().count() != static_cast<std::int64_t>(last) ? 1 : 0;
        miscounted += dropped_ != last - 1 - taken ? 1 : 0;
        outbox_->Release(report);
        ++taken;
      }
      if (last_round) return;
      outbox_->Wait();
    }
  });
  for (std::uint64_t i = 1; i <= kReports; ++i) {
    FrameReport report = Numbered(i);
    report.capture_time = CaptureTime(std::chrono::nanoseconds(i));
    outbox_->Offer(report);
  }
  done = true;
  outbox_->Wake();
  consumer.join();
  EXPECT_EQ(taken + outbox_->dropped(), kReports);
  EXPECT_GT(outbox_->dropped(), 0u) << "the test shall see an overrun";
  EXPECT_EQ(disorder, 0u);
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(miscounted, 0u);
}

}  // namespace
}  // namespace wirepose
