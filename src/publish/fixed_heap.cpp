#include "publish/fixed_heap.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>

#include "base/check.h"

namespace wirepose {
namespace {

constexpr std::size_t kFree = 1;          // this chunk is free
constexpr std::size_t kPreviousFree = 2;  // the chunk before it is free
constexpr std::size_t kFlags = FixedHeap::kAlignment - 1;
constexpr std::size_t kHeader = sizeof(std::size_t);

}  // namespace

// What lies before a block. `previous` is the last word of the chunk before and valid only when that one is free; the
// two links lie in the block itself and are valid only when it is free.
struct FixedHeap::Chunk {
  Chunk* previous;
  std::size_t size_and_flags;  // bytes to the next chunk's header
  Chunk* next_free;
  Chunk* previous_free;

  [[nodiscard]] std::size_t size() const { return size_and_flags & ~kFlags; }
  [[nodiscard]] bool free() const { return (size_and_flags & kFree) != 0; }
  [[nodiscard]] bool previous_is_free() const { return (size_and_flags & kPreviousFree) != 0; }
  [[nodiscard]] std::byte* block() { return reinterpret_cast<std::byte*>(this) + offsetof(Chunk, next_free); }
  [[nodiscard]] Chunk* next() { return At(reinterpret_cast<std::byte*>(this) + size()); }

  static Chunk* At(std::byte* address) { return std::launder(reinterpret_cast<Chunk*>(address)); }
  static Chunk* Of(void* block) { return At(static_cast<std::byte*>(block) - offsetof(Chunk, next_free)); }
};

namespace {
constexpr std::size_t kMinChunk = 32;  // header, two links, and the next chunk's `previous`
constexpr std::size_t kMinStorage = 64;
}  // namespace

void FixedHeap::Reset(std::span<std::byte> storage) {
  Check(storage.size() >= kMinStorage && storage.size() <= kMaxCapacity);
  const auto address = reinterpret_cast<std::uintptr_t>(storage.data());
  const std::size_t shift = (kAlignment - address % kAlignment) % kAlignment;
  begin_ = storage.data() + shift;
  // At the end a header of an eternally used chunk, so that the last chunk has a next one.
  const std::size_t usable = (storage.size() - shift) / kAlignment * kAlignment;
  end_ = begin_ + usable;
  first_map_ = 0;
  second_map_ = {};
  lists_ = {};
  use_ = {};
  use_.capacity = usable - kMinChunk;
  Chunk* const all = Chunk::At(begin_);
  all->size_and_flags = usable - kMinChunk;
  Chunk* const last = all->next();
  last->size_and_flags = 0;
  Insert(all);
}

// Sizes are multiples of 16, at least kMinChunk.
FixedHeap::Class FixedHeap::ClassOf(std::size_t size) {
  const auto log = static_cast<std::size_t>(std::bit_width(size)) - 1;
  if (log < kLinearBits) return {0, size / kAlignment};
  return {log - kLinearBits + 1, (size >> (log - kSecondBits)) & (kSecondCount - 1)};
}

// The first chunk of the first list whose chunks all are large enough.
FixedHeap::Chunk* FixedHeap::FindFree(std::size_t size) const {
  const auto log = static_cast<std::size_t>(std::bit_width(size)) - 1;
  if (log >= kLinearBits) size += (std::size_t{1} << (log - kSecondBits)) - 1;
  Class wanted = ClassOf(size);
  if (wanted.first >= kFirstCount) return nullptr;
  std::uint32_t second = second_map_[wanted.first] & (~std::uint32_t{0} << wanted.second);
  if (second == 0) {
    const std::uint32_t first = first_map_ & static_cast<std::uint32_t>(~std::uint64_t{0} << (wanted.first + 1));
    if (first == 0) return nullptr;
    wanted.first = static_cast<std::size_t>(std::countr_zero(first));
    second = second_map_[wanted.first];
  }
  return lists_[wanted.first][static_cast<std::size_t>(std::countr_zero(second))];
}

// Marks the chunk free, for itself and for its neighbour, and hangs it in its list.
void FixedHeap::Insert(Chunk* chunk) {
  const Class c = ClassOf(chunk->size());
  Chunk*& head = lists_[c.first][c.second];
  chunk->size_and_flags |= kFree;
  chunk->previous_free = nullptr;
  chunk->next_free = head;
  if (head != nullptr) head->previous_free = chunk;
  head = chunk;
  first_map_ |= std::uint32_t{1} << c.first;
  second_map_[c.first] |= std::uint32_t{1} << c.second;
  Chunk* const next = chunk->next();
  next->previous = chunk;
  next->size_and_flags |= kPreviousFree;
}

// The opposite of Insert.
void FixedHeap::Remove(Chunk* chunk) {
  const Class c = ClassOf(chunk->size());
  if (chunk->next_free != nullptr) chunk->next_free->previous_free = chunk->previous_free;
  if (chunk->previous_free != nullptr) {
    chunk->previous_free->next_free = chunk->next_free;
  } else {
    lists_[c.first][c.second] = chunk->next_free;
    if (chunk->next_free == nullptr) {
      second_map_[c.first] &= ~(std::uint32_t{1} << c.second);
      if (second_map_[c.first] == 0) first_map_ &= ~(std::uint32_t{1} << c.first);
    }
  }
  chunk->size_and_flags &= ~kFree;
  chunk->next()->size_and_flags &= ~kPreviousFree;
}

// Gives back what a used chunk has beyond `size`, if that is enough for a chunk.
void FixedHeap::Split(Chunk* chunk, std::size_t size) {
  const std::size_t rest = chunk->size() - size;
  if (rest < kMinChunk) return;
  chunk->size_and_flags = size | (chunk->size_and_flags & kFlags);
  Chunk* const tail = chunk->next();
  tail->size_and_flags = rest;
  Insert(tail);
}

void* FixedHeap::Alloc(std::size_t bytes) {
  ++use_.allocations;
  if (bytes > use_.capacity) return nullptr;
  const std::size_t size = std::max(kMinChunk, (bytes + kHeader + kAlignment - 1) / kAlignment * kAlignment);
  Chunk* const chunk = FindFree(size);
  if (chunk == nullptr) return nullptr;
  Remove(chunk);
  Split(chunk, size);
  ++use_.blocks;
  use_.used += chunk->size();
  use_.high_water = std::max(use_.high_water, use_.used);
  return chunk->block();
}

void* FixedHeap::Resize(void* block, std::size_t bytes) {
  Chunk* const chunk = Chunk::Of(block);
  Check(Owns(chunk));
  const std::size_t room = chunk->size() - kHeader;
  if (bytes <= room && bytes >= room / 2) return block;
  void* const moved = Alloc(bytes);
  if (moved == nullptr) return nullptr;
  std::memcpy(moved, block, std::min(room, bytes));
  Free(block);
  return moved;
}

bool FixedHeap::Owns(const Chunk* chunk) const {
  const auto* const address = reinterpret_cast<const std::byte*>(chunk);
  return address >= begin_ && address < end_ && static_cast<std::size_t>(address - begin_) % kAlignment == 0 &&
         !chunk->free() && chunk->size() >= kMinChunk && chunk->size() <= static_cast<std::size_t>(end_ - address);
}

void FixedHeap::Free(void* block) {
  Chunk* chunk = Chunk::Of(block);
  Check(Owns(chunk));
  --use_.blocks;
  use_.used -= chunk->size();
  if (chunk->previous_is_free()) {
    Chunk* const previous = chunk->previous;
    Remove(previous);
    previous->size_and_flags += chunk->size();
    chunk = previous;
  }
  if (Chunk* const next = chunk->next(); next->free()) {
    Remove(next);
    chunk->size_and_flags += next->size();
  }
  Insert(chunk);
}

}  // namespace wirepose
