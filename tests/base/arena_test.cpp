#include "base/arena.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace wirepose {
namespace {

TEST(Arena, GivesEveryByteOnce) {
  alignas(16) std::byte storage[64];
  Arena arena(storage);
  EXPECT_EQ(arena.Allocate(60, 1), storage);
  EXPECT_EQ(arena.Allocate(4, 4), storage + 60);
  EXPECT_EQ(arena.used(), 64u);
  EXPECT_EQ(arena.Allocate(1, 1), nullptr);
  EXPECT_EQ(arena.failed_count(), 1u);
}

TEST(Arena, RefusalChangesNothing) {
  alignas(16) std::byte storage[32];
  Arena arena(storage);
  ASSERT_NE(arena.Allocate(1, 1), nullptr);
  EXPECT_EQ(arena.Allocate(32, 1), nullptr);
  EXPECT_EQ(arena.Allocate(17, 16), nullptr) << "fits without, but not with its alignment";
  EXPECT_EQ(arena.used(), 1u);
  EXPECT_NE(arena.Allocate(16, 16), nullptr);
}

TEST(Arena, HugeRequestsDoNotWrapAround) {
  std::byte storage[32];
  Arena arena(storage);
  ASSERT_NE(arena.Allocate(1, 1), nullptr);
  EXPECT_EQ(arena.Allocate(~std::size_t{0}, 1), nullptr);
  EXPECT_EQ(arena.AllocateArray<double>(~std::size_t{0} / 4).data(), nullptr);
  EXPECT_EQ(arena.failed_count(), 2u);
}

TEST(Arena, ArraysAreValueInitialised) {
  alignas(8) std::byte storage[64];
  std::fill(std::begin(storage), std::end(storage), std::byte{0xFF});
  Arena arena(storage);
  for (const std::uint32_t value : arena.AllocateArray<std::uint32_t>(16)) EXPECT_EQ(value, 0u);
}

TEST(Arena, ScopesRewindAndHighWaterRemains) {
  alignas(16) std::byte storage[64];
  Arena arena(storage);
  ASSERT_NE(arena.Allocate(8, 1), nullptr);
  {
    const ArenaScope outer(arena);
    ASSERT_NE(arena.Allocate(16, 1), nullptr);
    {
      const ArenaScope inner(arena);
      ASSERT_NE(arena.Allocate(32, 1), nullptr);
    }
    EXPECT_EQ(arena.used(), 24u);
  }
  EXPECT_EQ(arena.used(), 8u);
  EXPECT_EQ(arena.high_water(), 56u);
}

TEST(ArenaDeathTest, HaltsOnAnAlignmentThatIsNoPowerOfTwo) {
  std::byte storage[32];
  Arena arena(storage);
  EXPECT_DEATH((void)arena.Allocate(1, 3), "");
}

// Random requests: inside the storage, aligned, disjoint from all that lives; refused only when it
// cannot fit.
TEST(Arena, RandomRequestsAreDisjointAndAligned) {
  std::mt19937 random(11);
  alignas(64) std::byte storage[4096];
  for (int round = 0; round < 300; ++round) {
    Arena arena(storage);
    std::byte* free_from = storage;
    for (;;) {
      const std::size_t bytes = random() % 200;
      const std::size_t alignment = std::size_t{1} << (random() % 7);
      auto* const p = static_cast<std::byte*>(arena.Allocate(bytes, alignment));
      const std::size_t offset = static_cast<std::size_t>(free_from - storage);
      const std::size_t aligned = (offset + alignment - 1) / alignment * alignment;
      if (p == nullptr) {
        ASSERT_GT(aligned + bytes, sizeof storage);
        break;
      }
      ASSERT_EQ(p, storage + aligned);
      free_from = p + bytes;
      ASSERT_EQ(arena.used(), aligned + bytes);
    }
  }
}

}  // namespace
}  // namespace wirepose
