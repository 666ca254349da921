#include "base/memory_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <set>
#include <thread>
#include <vector>

namespace wirepose {
namespace {

TEST(MemoryPool, StartsEmptyAndKnowsItsSizes) {
  StaticMemoryPool<24, 3> pool;
  EXPECT_EQ(pool.capacity(), 3u);
  EXPECT_GE(pool.block_size(), 24u);
  EXPECT_EQ(pool.count(), 0u);
  EXPECT_EQ(pool.space(), 3u);
  EXPECT_EQ(pool.high_water(), 0u);
}

TEST(MemoryPool, GivesAlignedDistinctBlocksUntilExhausted) {
  StaticMemoryPool<10, 4, 64> pool;
  std::set<void*> blocks;
  for (int i = 0; i < 4; ++i) {
    void* const block = pool.Alloc();
    ASSERT_NE(block, nullptr);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % 64, 0u);
    std::memset(block, 0xAA, pool.block_size());
    EXPECT_TRUE(blocks.insert(block).second);
  }
  EXPECT_EQ(pool.Alloc(), nullptr);
  EXPECT_EQ(pool.failed_count(), 1u);
  EXPECT_EQ(pool.count(), 4u);
}

TEST(MemoryPool, AFreedBlockIsGivenAgain) {
  StaticMemoryPool<8, 1> pool;
  void* const first = pool.Alloc();
  EXPECT_EQ(pool.Free(first), PoolStatus::kOk);
  EXPECT_EQ(pool.Alloc(), first);
  EXPECT_EQ(pool.high_water(), 1u);
}

TEST(MemoryPool, RefusesDoubleFree) {
  StaticMemoryPool<8, 2> pool;
  void* const a = pool.Alloc();
  void* const b = pool.Alloc();
  EXPECT_EQ(pool.Free(a), PoolStatus::kOk);
  EXPECT_EQ(pool.Free(a), PoolStatus::kDoubleFree);
  EXPECT_EQ(pool.count(), 1u);
  EXPECT_EQ(pool.Free(b), PoolStatus::kOk);
  EXPECT_EQ(pool.Free(b), PoolStatus::kDoubleFree);
  EXPECT_EQ(pool.space(), 2u);
}

TEST(MemoryPool, RefusesABlockNeverGiven) {
  StaticMemoryPool<16, 3> pool;
  auto* const first = static_cast<std::byte*>(pool.Alloc());
  EXPECT_EQ(pool.Free(first + pool.block_size()), PoolStatus::kDoubleFree);
  EXPECT_EQ(pool.count(), 1u);
}

TEST(MemoryPool, RefusesForeignPointers) {
  StaticMemoryPool<16, 3> pool;
  auto* const block = static_cast<std::byte*>(pool.Alloc());
  int elsewhere = 0;
  EXPECT_EQ(pool.Free(nullptr), PoolStatus::kForeignPointer);
  EXPECT_EQ(pool.Free(&elsewhere), PoolStatus::kForeignPointer);
  EXPECT_EQ(pool.Free(block + 1), PoolStatus::kForeignPointer);
  EXPECT_EQ(pool.Free(block + 3 * pool.block_size()), PoolStatus::kForeignPointer);
  EXPECT_EQ(pool.count(), 1u);
  EXPECT_EQ(pool.Free(block), PoolStatus::kOk);
}

TEST(MemoryPool, WorksOnStorageOfTheCaller) {
  alignas(8) std::byte storage[40];
  PoolSlot slots[5];
  MemoryPool pool(storage, slots, 8);
  for (std::size_t i = 0; i < 5; ++i) {
    auto* const block = static_cast<std::byte*>(pool.Alloc());
    ASSERT_TRUE(block >= storage && block + 8 <= storage + sizeof storage);
  }
  EXPECT_EQ(pool.Alloc(), nullptr);
}

TEST(MemoryPoolDeathTest, HaltsOnStorageThatIsTooSmall) {
  std::byte storage[39];
  PoolSlot slots[5];
  EXPECT_DEATH(MemoryPool(storage, slots, 8), "");
}

// Random allocations and frees, good and bad, against a set of the blocks in use.
TEST(MemoryPool, AgreesWithASetOfLiveBlocks) {
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    StaticMemoryPool<32, 17> pool;
    std::vector<std::pair<std::byte*, int>> live;
    std::vector<std::byte*> dead;
    std::size_t most = 0;
    for (int step = 0; step < 500; ++step) {
      if (random() % 2 == 0) {
        auto* const block = static_cast<std::byte*>(pool.Alloc());
        ASSERT_EQ(block == nullptr, live.size() == 17);
        if (block == nullptr) continue;
        std::memset(block, step & 0xFF, pool.block_size());
        std::erase(dead, block);
        live.emplace_back(block, step & 0xFF);
      } else if (!live.empty()) {
        const std::size_t i = random() % live.size();
        const auto [block, fill] = live[i];
        // Nobody wrote into the block while it was ours.
        ASSERT_TRUE(std::all_of(block, block + pool.block_size(), [&](std::byte b) { return b == std::byte(fill); }));
        ASSERT_EQ(pool.Free(block), PoolStatus::kOk);
        live.erase(live.begin() + static_cast<std::ptrdiff_t>(i));
        dead.push_back(block);
      }
      if (!dead.empty() && random() % 8 == 0) {
        ASSERT_EQ(pool.Free(dead[random() % dead.size()]), PoolStatus::kDoubleFree);
      }
      most = std::max(most, live.size());
      ASSERT_EQ(pool.count(), live.size());
      ASSERT_EQ(pool.high_water(), most);
    }
  }
}

// Four threads write their name into blocks and look whether anybody else did too.
TEST(MemoryPool, GivesNoBlockToTwoThreads) {
  auto pool = std::make_unique<StaticMemoryPool<8, 5>>();
  std::atomic<int> conflicts{0};
  std::vector<std::thread> threads;
  for (int name = 1; name <= 4; ++name) {
    threads.emplace_back([&, name] {
      for (int i = 0; i < 20000; ++i) {
        auto* const block = static_cast<std::atomic<int>*>(pool->Alloc());
        if (block == nullptr) continue;
        block->store(name);
        if (i % 64 == 0) std::this_thread::yield();
        if (block->load() != name) ++conflicts;
        if (pool->Free(block) != PoolStatus::kOk) ++conflicts;
      }
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(conflicts, 0);
  EXPECT_EQ(pool->count(), 0u);
  EXPECT_LE(pool->high_water(), 4u);
  std::set<void*> blocks;
  for (void* block = pool->Alloc(); block != nullptr; block = pool->Alloc()) blocks.insert(block);
  EXPECT_EQ(blocks.size(), 5u) << "a block was lost or doubled";
}

}  // namespace
}  // namespace wirepose
