// Blocks of one size, given out and taken back in constant time: the memory pool of CMSIS-RTOS2
// (osMemoryPool).
#ifndef WIREPOSE_BASE_MEMORY_POOL_H_
#define WIREPOSE_BASE_MEMORY_POOL_H_

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace wirepose {

enum class [[nodiscard]] PoolStatus : std::uint8_t{
    kOk,
    kForeignPointer,  // not the address of one of this pool's blocks; nothing changed
    kDoubleFree,      // the block is free already; nothing changed
};

// Bookkeeping of one block. Kept apart from the block, so that an overrun of a block cannot break
// the pool.
struct PoolSlot {
  std::atomic<std::uint16_t> next{0};
  std::atomic<bool> allocated{false};
};

// The pool without its capacity: what APIs take. The storage is the caller's (or
// StaticMemoryPool's) and must outlive the pool.
//
// Threads: any number may call any method at once; lock-free (a 32 bit compare-and-swap), no call
// blocks. The free list's head carries a 16 bit tag against the ABA problem: a thread would have to
// be suspended inside Alloc while exactly a multiple of 65,536 other calls succeed. Complexity:
// every method O(1), without contention.
class MemoryPool {
 public:
  static constexpr std::size_t kMaxBlocks = 0xFFFE;

  // `storage` holds slots.size() blocks of `block_size` bytes, back to back; 0 < slots.size() <=
  // kMaxBlocks. Halts otherwise: the sizes are compile-time facts.
  MemoryPool(std::span<std::byte> storage, std::span<PoolSlot> slots, std::size_t block_size);
  MemoryPool(const MemoryPool&) = delete;
  MemoryPool& operator=(const MemoryPool&) = delete;

  // A block with indeterminate content, or nullptr when all are in use (counted by failed_count()).
  [[nodiscard]] void* Alloc();
  // Takes back a block from Alloc. Anything else is refused.
  PoolStatus Free(void* block);

  [[nodiscard]] std::size_t capacity() const { return slots_.size(); }
  [[nodiscard]] std::size_t block_size() const { return block_size_; }
  // Blocks in use now, free now, and the most ever in use.
  [[nodiscard]] std::size_t count() const { return count_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t space() const { return capacity() - count(); }
  [[nodiscard]] std::size_t high_water() const { return high_water_.load(std::memory_order_relaxed); }
  // Calls of Alloc that found no block.
  [[nodiscard]] std::uint32_t failed_count() const { return failed_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::uint16_t kNone = 0xFFFF;
  static constexpr std::uint32_t Pack(std::uint16_t index, std::uint16_t tag) {
    return (std::uint32_t{tag} << 16) | index;
  }
  static constexpr std::uint16_t IndexOf(std::uint32_t head) { return static_cast<std::uint16_t>(head & 0xFFFF); }
  static constexpr std::uint16_t NextTag(std::uint32_t head) { return static_cast<std::uint16_t>((head >> 16) + 1); }
  void RaiseHighWater(std::size_t count);

  const std::span<std::byte> storage_;
  const std::span<PoolSlot> slots_;
  const std::size_t block_size_;
  std::atomic<std::uint32_t> head_{Pack(kNone, 0)};  // tag and index of the first free block
  std::atomic<std::size_t> count_{0};
  std::atomic<std::size_t> high_water_{0};
  std::atomic<std::uint32_t> failed_{0};
};

namespace internal {
// A base class, so that the storage is constructed before the pool that refers to it.
template <std::size_t kBlockBytes, std::size_t kBlockCount, std::size_t kAlignment>
struct PoolStorage {
  alignas(kAlignment) std::byte bytes[kBlockBytes * kBlockCount];
  PoolSlot pool_slots[kBlockCount];
};
constexpr std::size_t RoundUp(std::size_t n, std::size_t multiple) { return (n + multiple - 1) / multiple * multiple; }
}  // namespace internal

// A pool with its storage inside: make it static. Blocks are at least `kBlockSize` bytes, aligned
// to `kAlignment`.
template <std::size_t kBlockSize, std::size_t kBlockCount, std::size_t kAlignment = alignof(std::max_align_t)>
class StaticMemoryPool
    : private internal::PoolStorage<internal::RoundUp(kBlockSize, kAlignment), kBlockCount, kAlignment>,
      public MemoryPool {
  static_assert(kBlockSize > 0 && kBlockCount > 0 && kBlockCount <= MemoryPool::kMaxBlocks);

 public:
  StaticMemoryPool() : MemoryPool(this->bytes, this->pool_slots, internal::RoundUp(kBlockSize, kAlignment)) {}
};

}  // namespace wirepose

#include "base/memory_pool_inl.h"  // IWYU pragma: export

#endif  // WIREPOSE_BASE_MEMORY_POOL_H_
