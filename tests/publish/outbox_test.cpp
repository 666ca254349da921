#include "publish/outbox.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "reports_for_test.h"

namespace wirepose {
namespace {

FrameReport Numbered(std::uint64_t sequence) {
  FrameReport report;
  report.sequence = sequence;
  return report;
}

TEST(Outbox, GivesReportsInOrder) {
  const auto outbox = std::make_unique<Outbox>();
  EXPECT_EQ(outbox->TakeFrame(), nullptr);
  EXPECT_TRUE(outbox->Offer(Numbered(1)));
  EXPECT_TRUE(outbox->Offer(Numbered(2)));
  for (std::uint64_t expected = 1; expected <= 2; ++expected) {
    const FrameReport* const report = outbox->TakeFrame();
    ASSERT_NE(report, nullptr);
    EXPECT_EQ(report->sequence, expected);
    outbox->Release(report);
  }
  EXPECT_EQ(outbox->TakeFrame(), nullptr);
}

// A publisher that never takes anything: the vision thread is told so at once, every time.
TEST(Outbox, StalledConsumerCostsReportsNotTime) {
  const auto outbox = std::make_unique<Outbox>();
  for (std::uint64_t i = 0; i < 100; ++i) {
    EXPECT_EQ(outbox->Offer(Numbered(i)), i < Outbox::kQueueCapacity);
  }
  EXPECT_EQ(outbox->dropped(), 100 - Outbox::kQueueCapacity);
  // Once the consumer is back, the next report says how many were lost before it.
  for (std::uint64_t i = 0; i < Outbox::kQueueCapacity; ++i) {
    const FrameReport* const report = outbox->TakeFrame();
    ASSERT_NE(report, nullptr);
    EXPECT_EQ(report->results_dropped, 0u);
    outbox->Release(report);
  }
  ASSERT_TRUE(outbox->Offer(Numbered(100)));
  const FrameReport* const report = outbox->TakeFrame();
  EXPECT_EQ(report->results_dropped, 96u);
  outbox->Release(report);
}

TEST(Outbox, ReportBeingWrittenDoesNotTakeRoomInTheQueue) {
  const auto outbox = std::make_unique<Outbox>();
  ASSERT_TRUE(outbox->Offer(Numbered(0)));
  const FrameReport* const writing = outbox->TakeFrame();
  for (std::uint64_t i = 1; i <= Outbox::kQueueCapacity; ++i) EXPECT_TRUE(outbox->Offer(Numbered(i)));
  EXPECT_FALSE(outbox->Offer(Numbered(99)));
  EXPECT_EQ(writing->sequence, 0u) << "overwritten while being written";
  EXPECT_EQ(outbox->high_water(), outbox->capacity());
  outbox->Release(writing);
}

TEST(Outbox, HealthGoesItsOwnWay) {
  const auto outbox = std::make_unique<Outbox>();
  while (outbox->Offer(Numbered(0))) {
  }
  HealthReport health;
  health.uptime_ns = 77;
  EXPECT_TRUE(outbox->Offer(health)) << "frames that wait must not keep health back";
  HealthReport taken;
  ASSERT_TRUE(outbox->TakeHealth(taken));
  EXPECT_EQ(taken.uptime_ns, 77u);
  EXPECT_FALSE(outbox->TakeHealth(taken));
}

TEST(Outbox, TwoThreadsLoseNothingUncounted) {
  const auto outbox = std::make_unique<Outbox>();
  constexpr std::uint64_t kReports = 20000;
  std::atomic<bool> done{false};
  std::uint64_t taken = 0;
  std::uint64_t disorder = 0;
  std::thread consumer([&] {
    std::uint64_t last = 0;
    for (;;) {
      const bool last_round = done;
      while (const FrameReport* const report = outbox->TakeFrame()) {
        disorder += report->sequence <= last;
        last = report->sequence;
        outbox->Release(report);
        ++taken;
      }
      if (last_round) return;
      outbox->Wait();
    }
  });
  for (std::uint64_t i = 1; i <= kReports; ++i) (void)outbox->Offer(Numbered(i));
  done = true;
  outbox->Wake();
  consumer.join();
  EXPECT_EQ(taken + outbox->dropped(), kReports);
  EXPECT_EQ(disorder, 0u);
}

}  // namespace
}  // namespace wirepose
