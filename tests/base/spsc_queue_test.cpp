#include "base/spsc_queue.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <random>
#include <thread>

namespace wirepose {
namespace {

TEST(SpscQueue, EmptyQueueGivesNothing) {
  SpscQueue<int, 2> queue;
  int value = 42;
  EXPECT_FALSE(queue.try_pop(value));
  EXPECT_EQ(value, 42);
  EXPECT_TRUE(queue.empty());
}

TEST(SpscQueue, HoldsExactlyItsCapacity) {
  SpscQueue<int, 3> queue;
  EXPECT_TRUE(queue.try_push(1));
  EXPECT_TRUE(queue.try_push(2));
  EXPECT_TRUE(queue.try_push(3));
  EXPECT_FALSE(queue.try_push(4));
  EXPECT_EQ(queue.size(), 3u);
  int value = 0;
  for (int expected = 1; expected <= 3; ++expected) {
    ASSERT_TRUE(queue.try_pop(value));
    EXPECT_EQ(value, expected);
  }
  EXPECT_FALSE(queue.try_pop(value));
}

template <std::size_t kCapacity>
void CompareWithDeque(unsigned seed) {
  std::mt19937 random(seed);
  SpscQueue<std::uint32_t, kCapacity> queue;
  std::deque<std::uint32_t> oracle;
  for (int step = 0; step < 20000; ++step) {
    // Long phases of mostly pushes and mostly pops reach both ends.
    const bool push = random() % 10 < ((step / 50) % 2 == 0 ? 7u : 3u);
    if (push) {
      const auto value = static_cast<std::uint32_t>(random());
      ASSERT_EQ(queue.try_push(value), oracle.size() < kCapacity);
      if (oracle.size() < kCapacity) oracle.push_back(value);
    } else {
      std::uint32_t value = 0;
      ASSERT_EQ(queue.try_pop(value), !oracle.empty());
      if (!oracle.empty()) {
        ASSERT_EQ(value, oracle.front());
        oracle.pop_front();
      }
    }
    ASSERT_EQ(queue.size(), oracle.size());
  }
}

TEST(SpscQueue, AgreesWithDeque) {
  CompareWithDeque<1>(1);
  CompareWithDeque<2>(2);
  CompareWithDeque<7>(3);
  CompareWithDeque<64>(4);
}

// Every element arrives once, in order and whole, while both threads run.
TEST(SpscQueue, TwoThreadsLoseAndTearNothing) {
  struct Element {
    std::uint64_t a, b, c;
  };
  constexpr std::uint64_t kCount = 200000;
  auto queue = std::make_unique<SpscQueue<Element, 5>>();
  std::thread producer([&] {
    for (std::uint64_t i = 0; i < kCount; ++i) {
      while (!queue->try_push({i, ~i, i * 3})) std::this_thread::yield();
    }
  });
  std::uint64_t wrong = 0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    Element e{};
    while (!queue->try_pop(e)) std::this_thread::yield();
    wrong += e.a != i || e.b != ~i || e.c != i * 3;
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_TRUE(queue->empty());
}

}  // namespace
}  // namespace wirepose
