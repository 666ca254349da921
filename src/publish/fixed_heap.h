// A heap in memory of fixed size: blocks of any size, in constant time.
#ifndef WIREPOSE_PUBLISH_FIXED_HEAP_H_
#define WIREPOSE_PUBLISH_FIXED_HEAP_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace wirepose {

struct HeapUse {
  std::size_t used = 0;        // bytes, each block's overhead included
  std::size_t high_water = 0;  // most bytes ever used at once
  std::size_t capacity = 0;
  std::size_t blocks = 0;         // in use now
  std::uint64_t allocations = 0;  // since the start
};

// Two-level segregated fit (Masmano, Ripoll, Crespo, Real: TLSF, ECRTS 2004): free blocks hang in lists by size class, 16
// classes to each power of two; two bit maps find the first list that fits; neighbours that are free merge at once. So
// the waste by rounding is at most 1/16 and memory that was freed serves every size again.
//
// The storage is the caller's and must outlive the heap. Not thread safe. Every call is O(1), but Resize copies.
class FixedHeap {
 public:
  static constexpr std::size_t kAlignment = 16;
  static constexpr std::size_t kMaxCapacity = std::size_t{1} << 30;

  constexpr FixedHeap() = default;
  FixedHeap(const FixedHeap&) = delete;
  FixedHeap& operator=(const FixedHeap&) = delete;

  // Makes all of `storage` (64 bytes to kMaxCapacity) one free block and forgets what was there.
  void Reset(std::span<std::byte> storage);

  // A block of at least `bytes`, aligned to kAlignment, with indeterminate content; nullptr when none fits. Zero bytes
  // give a block as well.
  [[nodiscard]] void* Alloc(std::size_t bytes);
  // The same block or a larger one with the same content; nullptr, and the old one unchanged, when none fits.
  [[nodiscard]] void* Resize(void* block, std::size_t bytes);
  // Takes back a block of Alloc or Resize. Halts when it is none: that is somebody's bug and would corrupt the rest.
  void Free(void* block);

  [[nodiscard]] const HeapUse& use() const { return use_; }

 private:
  struct Chunk;
  struct Class {
    std::size_t first = 0, second = 0;
  };
  static constexpr std::size_t kSecondBits = 4;
  static constexpr std::size_t kSecondCount = std::size_t{1} << kSecondBits;
  static constexpr std::size_t kLinearBits = 8;  // below 256 bytes the classes are 16 bytes apart
  static constexpr std::size_t kFirstCount = 30 - kLinearBits + 2;

  static Class ClassOf(std::size_t size);
  [[nodiscard]] Chunk* FindFree(std::size_t size) const;
  void Insert(Chunk* chunk);
  void Remove(Chunk* chunk);
  [[nodiscard]] bool Owns(const Chunk* chunk) const;
  void Split(Chunk* chunk, std::size_t size);

  std::byte* begin_ = nullptr;
  std::byte* end_ = nullptr;
  std::uint32_t first_map_ = 0;
  std::array<std::uint32_t, kFirstCount> second_map_{};
  std::array<std::array<Chunk*, kSecondCount>, kFirstCount> lists_{};
  HeapUse use_;
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_FIXED_HEAP_H_
