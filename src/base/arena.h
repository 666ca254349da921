// A bump allocator over storage that somebody else owns: scratch memory of one frame, freed all at
// once.
#ifndef WIREPOSE_BASE_ARENA_H_
#define WIREPOSE_BASE_ARENA_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <type_traits>

#include "base/check.h"

namespace wirepose {

// Hands out the bytes of `storage` one after the other. Nothing is freed singly: an ArenaScope
// gives back all that was taken inside it. Not thread safe. Allocate is O(1), AllocateArray
// O(elements) because it constructs them.
class Arena {
 public:
  explicit Arena(std::span<std::byte> storage) : storage_(storage) {}
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  // `bytes` of indeterminate content at a multiple of `alignment` (a power of two); nullptr, and no
  // change but failed_count(), when they do not fit.
  [[nodiscard]] void* Allocate(std::size_t bytes, std::size_t alignment = alignof(std::max_align_t)) {
    Check(alignment != 0 && (alignment & (alignment - 1)) == 0);
    const auto address = reinterpret_cast<std::uintptr_t>(storage_.data()) + used_;
    const std::size_t padding = (alignment - address % alignment) % alignment;
    const std::size_t left = storage_.size() - used_;
    if (padding > left || bytes > left - padding) {
      ++failed_;
      return nullptr;
    }
    void* const start = storage_.data() + used_ + padding;
    used_ += padding + bytes;
    high_water_ = std::max(high_water_, used_);
    return start;
  }

  // `count` value-initialised elements; a span with data() == nullptr when they do not fit.
  template <typename T>
  [[nodiscard]] std::span<T> AllocateArray(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T>, "the arena never calls a destructor");
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(T)) {
      ++failed_;
      return {};
    }
    T* const first = static_cast<T*>(Allocate(count * sizeof(T), alignof(T)));
    if (first == nullptr) return {};
    std::uninitialized_value_construct_n(first, count);
    return {first, count};
  }

  // One default-initialised T: arrays in it have indeterminate content. nullptr when it does not fit.
  template <typename T>
  [[nodiscard]] T* Create() {
    static_assert(std::is_trivially_destructible_v<T>, "the arena never calls a destructor");
    void* const place = Allocate(sizeof(T), alignof(T));
    return place != nullptr ? ::new (place) T : nullptr;
  }

  [[nodiscard]] std::size_t capacity() const { return storage_.size(); }
  [[nodiscard]] std::size_t used() const { return used_; }              // padding included
  [[nodiscard]] std::size_t high_water() const { return high_water_; }  // largest used() ever
  [[nodiscard]] std::uint32_t failed_count() const { return failed_; }

 private:
  friend class ArenaScope;

  std::span<std::byte> storage_;
  std::size_t used_ = 0;
  std::size_t high_water_ = 0;
  std::uint32_t failed_ = 0;
};

// Rewinds `arena` at its end to where it stood at its beginning. Scopes nest like blocks; what was
// allocated inside must not be used afterwards.
class [[nodiscard]] ArenaScope {
 public:
  explicit ArenaScope(Arena& arena) : arena_(arena), mark_(arena.used_) {}
  ~ArenaScope() {
    Check(arena_.used_ >= mark_);  // scopes ended in the wrong order
    arena_.used_ = mark_;
  }
  ArenaScope(const ArenaScope&) = delete;
  ArenaScope& operator=(const ArenaScope&) = delete;

 private:
  Arena& arena_;
  const std::size_t mark_;
};

}  // namespace wirepose

#endif  // WIREPOSE_BASE_ARENA_H_
