#include "publish/latest_ring.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace wirepose {
namespace {

using Ring = LatestRing<std::uint64_t, 4>;

TEST(LatestRing, KeepsTheNewestInOrder) {
  Ring ring;
  for (std::uint64_t i = 0; i < 10; ++i) EXPECT_EQ(ring.Put(i), i >= Ring::depth());
  for (std::uint64_t expected = 6; expected < 10; ++expected) {
    std::uint64_t number = 0;
    const std::uint64_t* const item = ring.Take(number);
    ASSERT_NE(item, nullptr);
    EXPECT_EQ(*item, expected);
    EXPECT_EQ(number, expected);
    ring.Release(item);
  }
  std::uint64_t number = 0;
  EXPECT_EQ(ring.Take(number), nullptr);
  EXPECT_EQ(ring.high_water(), Ring::depth());
}

// The taker looks again and again, so that its look over the places meets the putter at every step: an item of which
// only newer neighbours were seen must not be passed over.
TEST(LatestRing, TakesInOrderWhateverTheThreadsDo) {
  constexpr std::uint64_t kPuts = 500'000;
  Ring ring;
  std::atomic<bool> done{false};
  std::uint64_t replaced = 0, taken = 0, disorder = 0, torn = 0;
  std::thread taker([&] {
    std::uint64_t next = 0;
    for (bool last_round = false; !last_round;) {
      last_round = done;
      std::uint64_t number = 0;
      while (const std::uint64_t* const item = ring.Take(number)) {
        disorder += number < next ? 1 : 0;
        torn += *item != number ? 1 : 0;
        next = number + 1;
        ++taken;
        ring.Release(item);
      }
    }
  });
  for (std::uint64_t i = 0; i < kPuts; ++i) replaced += ring.Put(i) ? 1 : 0;
  done = true;
  taker.join();
  EXPECT_EQ(taken + replaced, kPuts);
  EXPECT_EQ(disorder, 0u);
  EXPECT_EQ(torn, 0u);
}

}  // namespace
}  // namespace wirepose
