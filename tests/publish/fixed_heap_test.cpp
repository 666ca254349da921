#include "publish/fixed_heap.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <vector>

namespace wirepose {
namespace {

class FixedHeapTest : public ::testing::Test {
 protected:
  void UseBytes(std::size_t bytes) {
    storage_.assign(bytes + FixedHeap::kAlignment, std::byte{0});
    heap_->Reset(storage_);
  }

  std::vector<std::byte> storage_;
  std::unique_ptr<FixedHeap> heap_ = std::make_unique<FixedHeap>();
};

TEST_F(FixedHeapTest, BlocksAreAlignedAndApart) {
  UseBytes(64 << 10);
  std::map<std::byte*, std::size_t> blocks;
  for (std::size_t bytes = 0; bytes < 300; ++bytes) {
    auto* const block = static_cast<std::byte*>(heap_->Alloc(bytes));
    ASSERT_NE(block, nullptr);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % FixedHeap::kAlignment, 0u);
    EXPECT_GE(block, storage_.data());
    EXPECT_LE(block + bytes, storage_.data() + storage_.size());
    blocks[block] = bytes;
  }
  const std::byte* end = nullptr;
  for (const auto& [block, bytes] : blocks) {
    EXPECT_GE(block, end);
    end = block + bytes;
  }
}

TEST_F(FixedHeapTest, FullMeansNullAndFreedMemoryServesEverySize) {
  UseBytes(64 << 10);
  std::vector<void*> blocks;
  while (void* const block = heap_->Alloc(100)) blocks.push_back(block);
  EXPECT_GT(blocks.size(), (64U << 10) / 128) << "at most 28 bytes of overhead each";
  EXPECT_EQ(heap_->Alloc(100), nullptr);
  const std::size_t full = heap_->use().high_water;
  for (std::size_t i = 0; i < blocks.size(); i += 2) heap_->Free(blocks[i]);
  for (std::size_t i = 1; i < blocks.size(); i += 2) heap_->Free(blocks[i]);
  EXPECT_EQ(heap_->use().used, 0u);
  EXPECT_EQ(heap_->use().blocks, 0u);
  EXPECT_EQ(heap_->use().high_water, full);
  EXPECT_NE(heap_->Alloc(60 << 10), nullptr) << "neighbours have not merged";
}

TEST_F(FixedHeapTest, ImpossibleSizesAreRefused) {
  UseBytes(4096);
  EXPECT_EQ(heap_->Alloc(4097), nullptr);
  EXPECT_EQ(heap_->Alloc(static_cast<std::size_t>(-1)), nullptr);
  EXPECT_EQ(heap_->Alloc(static_cast<std::size_t>(-1) / 2), nullptr);
  EXPECT_NE(heap_->Alloc(1024), nullptr);
}

TEST_F(FixedHeapTest, ResizeKeepsContent) {
  UseBytes(16 << 10);
  auto* block = static_cast<char*>(heap_->Alloc(10));
  std::strcpy(block, "wireframe");
  for (const std::size_t bytes : {20, 200, 2000, 15, 10}) {
    void* const moved = heap_->Resize(block, bytes);
    ASSERT_NE(moved, nullptr);
    block = static_cast<char*>(moved);
    EXPECT_STREQ(block, "wireframe");
  }
  EXPECT_EQ(heap_->Resize(block, 1 << 20), nullptr);
  EXPECT_STREQ(block, "wireframe") << "the old block is as it was";
  EXPECT_EQ(heap_->use().blocks, 1u);
}

// Thousands of random calls beside an oracle that knows what every block holds. At the end all memory is one block.
TEST_F(FixedHeapTest, AgreesWithTheOracle) {
  constexpr std::size_t kCapacity = 256 << 10;
  UseBytes(kCapacity);
  std::mt19937 random(11);
  std::map<unsigned char*, std::pair<std::size_t, unsigned char>> blocks;
  std::size_t failures = 0;
  const auto pick_size = [&] { return std::size_t{random() % (random() % 10 == 0 ? 20000 : 400)}; };
  const auto check = [&](auto entry) {
    for (std::size_t i = 0; i < entry->second.first; ++i) ASSERT_EQ(entry->first[i], entry->second.second);
  };
  for (int step = 0; step < 60000; ++step) {
    const bool grow = random() % 100 < (step / 5000 % 2 == 0 ? 60U : 40U);
    if (grow || blocks.empty()) {
      const std::size_t bytes = pick_size();
      auto* const block = static_cast<unsigned char*>(heap_->Alloc(bytes));
      if (block == nullptr) {
        ++failures;
        continue;
      }
      const auto mark = static_cast<unsigned char>(random());
      std::memset(block, mark, bytes);
      ASSERT_TRUE(blocks.emplace(block, std::pair(bytes, mark)).second) << "given out twice";
      continue;
    }
    auto victim = std::next(blocks.begin(), static_cast<std::ptrdiff_t>(random() % blocks.size()));
    check(victim);
    if (random() % 4 == 0) {
      const std::size_t bytes = pick_size();
      auto* const moved = static_cast<unsigned char*>(heap_->Resize(victim->first, bytes));
      if (moved == nullptr) continue;
      const auto mark = victim->second.second;
      for (std::size_t i = 0; i < std::min(bytes, victim->second.first); ++i) ASSERT_EQ(moved[i], mark);
      blocks.erase(victim);
      std::memset(moved, mark, bytes);
      blocks.emplace(moved, std::pair(bytes, mark));
    } else {
      heap_->Free(victim->first);
      blocks.erase(victim);
    }
    ASSERT_EQ(heap_->use().blocks, blocks.size());
  }
  EXPECT_GT(failures, 0u) << "the test shall see a full heap";
  std::size_t wanted = 0;
  for (auto entry = blocks.begin(); entry != blocks.end(); ++entry) {
    check(entry);
    wanted += entry->second.first;
  }
  EXPECT_GE(heap_->use().used, wanted);
  for (const auto& entry : blocks) heap_->Free(entry.first);
  EXPECT_EQ(heap_->use().used, 0u);
  EXPECT_NE(heap_->Alloc(kCapacity * 15 / 16 - 64), nullptr);
}

TEST(FixedHeapDeathTest, ForeignAndDoubleFreesHalt) {
  std::vector<std::byte> storage(4096);
  FixedHeap heap;
  heap.Reset(storage);
  void* const block = heap.Alloc(100);
  std::vector<std::byte> foreign(4096);
  EXPECT_DEATH(heap.Free(foreign.data() + 64), "");
  heap.Free(block);
  EXPECT_DEATH(heap.Free(block), "");
}

}  // namespace
}  // namespace wirepose
