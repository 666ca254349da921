// DDS in its static pool: this program links wirepose_dds_pool, as wireposed does.
#include "publish/dds_pool.h"

#include <gtest/gtest.h>

#include "bus_test_base.h"
#include "full_messages.h"

namespace wirepose {
namespace {

class PoolTest : public test::BusTest {
 protected:
  void SetUp() override {
    BusTest::SetUp();
    OpenPublisher();
  }
};

TEST_F(PoolTest, AllOfCyclonesHeapIsInIt) {
  const HeapUse use = DdsPoolUse();
  EXPECT_GT(use.capacity, kDefaultDdsPoolBytes - 100);
  EXPECT_LE(use.capacity, kDefaultDdsPoolBytes);
  std::printf("idle: %zu KiB\n", use.used >> 10);
  EXPECT_GT(use.used, std::size_t{100} << 10) << "the participant is elsewhere";
  EXPECT_LT(use.used, std::size_t{300} << 10) << "an idle participant with all topics needs less";
  // What Cyclone gives to us comes from it as well.
  void* const block = dds_alloc(1000);
  EXPECT_GT(DdsPoolUse().used, use.used);
  dds_free(block);
}

// The claim of the fixed memory: whatever the size of the message, publishing makes no heap call once the subscriber is
// there, on any thread, acknowledgements included. Beside it Cyclone makes a few in discovery, and for retransmissions
// to a subscriber that a busy machine leaves behind. Those come now and then; a call that publishing makes would come
// with every frame. Hence many short windows, of which some must see none at all.
TEST_F(PoolTest, PublishingToAnotherProcessAllocatesNothing) {
  constexpr std::chrono::microseconds kPace{10000};
  constexpr int kWindows = 15, kFrames = 15, kSilent = 3;
  for (const std::size_t objects : {std::size_t{0}, std::size_t{2}, kMaxDetections}) {
    const auto subscriber = Subscribe({"detections", "recognition"});
    ASSERT_TRUE(WaitForData(*subscriber, test::RandomReport(random_, 1)));
    const FrameReport report =
        objects == kMaxDetections ? test::FullFrame(random_) : test::RandomReport(random_, objects);
    Publish(50, report, kPace);  // free lists and history fill up
    int silent_windows = 0;
    std::uint64_t allocations = 0;
    const std::size_t used_before = DdsPoolUse().used;
    for (int window = 0; window < kWindows; ++window) {
      const std::uint64_t before = DdsPoolUse().allocations;
      Publish(kFrames, report, kPace);
      const std::uint64_t made = DdsPoolUse().allocations - before;
      silent_windows += made == 0 ? 1 : 0;
      allocations += made;
    }
    std::printf("%zu objects: %llu allocations in %d frames of two topics, %+lld bytes; none in %d of %d windows\n",
                objects, static_cast<unsigned long long>(allocations), kWindows * kFrames,
                static_cast<long long>(DdsPoolUse().used) - static_cast<long long>(used_before), silent_windows,
                kWindows);
    EXPECT_GE(silent_windows, kSilent);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const auto tallies = Finish(*subscriber);
    ASSERT_EQ(tallies.size(), 2u);
    // Keep-last: a subscriber that gets no processor time on a busy machine loses some.
    EXPECT_GE(tallies.at("recognition")["samples"], kWindows * kFrames / 4);
    EXPECT_EQ(publisher_->write_errors(), 0u);
  }
}

TEST_F(PoolTest, SizeCannotChangeOnceItIsInUse) { EXPECT_FALSE(SetDdsPoolSize(kMaxDdsPoolBytes)); }

// Cyclone cannot go on without memory: the program says so and what to do, and ends.
TEST(PoolDeathTest, FullPoolNamesTheRemedy) {
  EXPECT_DEATH(
      {
        for (;;) (void)dds_alloc(10000);
      },
      "the DDS pool is full: .* raise dds.pool_kib");
}

}  // namespace
}  // namespace wirepose
