// Bodies of memory_pool.h; src/base has no object code of its own.
#ifndef WIREPOSE_BASE_MEMORY_POOL_INL_H_
#define WIREPOSE_BASE_MEMORY_POOL_INL_H_

#include <functional>

#include "base/check.h"
#include "base/memory_pool.h"

namespace wirepose {

inline MemoryPool::MemoryPool(std::span<std::byte> storage, std::span<PoolSlot> slots, std::size_t block_size)
    : storage_(storage), slots_(slots), block_size_(block_size) {
  Check(block_size > 0 && !slots.empty() && slots.size() <= kMaxBlocks);
  Check(storage.size() / block_size >= slots.size());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const bool last = i + 1 == slots.size();
    slots[i].next.store(last ? kNone : static_cast<std::uint16_t>(i + 1), std::memory_order_relaxed);
  }
  head_.store(Pack(0, 0), std::memory_order_release);
}

inline void* MemoryPool::Alloc() {
  std::uint32_t head = head_.load(std::memory_order_acquire);
  while (IndexOf(head) != kNone) {
    // Another thread may take this block meanwhile; then `next` is stale, but the changed tag fails
    // the exchange.
    const std::uint16_t next = slots_[IndexOf(head)].next.load(std::memory_order_relaxed);
    if (head_.compare_exchange_weak(head, Pack(next, NextTag(head)), std::memory_order_acq_rel,
                                    std::memory_order_acquire)) {
      slots_[IndexOf(head)].allocated.store(true, std::memory_order_release);
      RaiseHighWater(count_.fetch_add(1, std::memory_order_relaxed) + 1);
      return storage_.data() + IndexOf(head) * block_size_;
    }
  }
  failed_.fetch_add(1, std::memory_order_relaxed);
  return nullptr;
}

inline PoolStatus MemoryPool::Free(void* block) {
  const auto* const p = static_cast<const std::byte*>(block);
  const std::byte* const first = storage_.data();
  const std::byte* const end = first + slots_.size() * block_size_;
  // std::less orders pointers into different objects too, which < does not.
  if (std::less<>{}(p, first) || !std::less<>{}(p, end)) return PoolStatus::kForeignPointer;
  const auto offset = static_cast<std::size_t>(p - first);
  if (offset % block_size_ != 0) return PoolStatus::kForeignPointer;

  const auto index = static_cast<std::uint16_t>(offset / block_size_);
  if (!slots_[index].allocated.exchange(false, std::memory_order_acq_rel)) {
    return PoolStatus::kDoubleFree;
  }
  // Before the block can be seen as free, lest count() exceed the capacity.
  count_.fetch_sub(1, std::memory_order_relaxed);
  std::uint32_t head = head_.load(std::memory_order_relaxed);
  do {
    slots_[index].next.store(IndexOf(head), std::memory_order_relaxed);
  } while (!head_.compare_exchange_weak(head, Pack(index, NextTag(head)), std::memory_order_acq_rel,
                                        std::memory_order_relaxed));
  return PoolStatus::kOk;
}

inline void MemoryPool::RaiseHighWater(std::size_t count) {
  std::size_t seen = high_water_.load(std::memory_order_relaxed);
  while (count > seen && !high_water_.compare_exchange_weak(seen, count, std::memory_order_relaxed)) {
  }
}

}  // namespace wirepose

#endif  // WIREPOSE_BASE_MEMORY_POOL_INL_H_
