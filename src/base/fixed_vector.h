// A sequence whose capacity is part of its type and whose storage is part of the object.
#ifndef WIREPOSE_BASE_FIXED_VECTOR_H_
#define WIREPOSE_BASE_FIXED_VECTOR_H_

#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

#include "base/check.h"

namespace wirepose {

// Elements live in place, in order of insertion. APIs take the capacity-erased `std::span`, to which it converts.
// Restricted to trivially destructible elements, so that clear() and destruction cost nothing.
// Not thread safe. Every operation is O(1) unless it says otherwise.
template <typename T, std::size_t kCapacity>
class FixedVector {
  static_assert(kCapacity > 0);
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  using value_type = T;

  static constexpr std::size_t capacity() { return kCapacity; }
  [[nodiscard]] constexpr std::size_t size() const { return size_; }
  [[nodiscard]] constexpr bool empty() const { return size_ == 0; }
  [[nodiscard]] constexpr bool full() const { return size_ == kCapacity; }

  // False, and no change, when full: the caller decides what overflow means and counts it.
  [[nodiscard]] constexpr bool try_push_back(const T& value) {
    if (full()) return false;
    items_[size_++] = value;
    return true;
  }

  // For callers that have proved there is room; halts otherwise.
  constexpr void push_back(const T& value) { Check(try_push_back(value)); }

  constexpr void pop_back() {
    Check(size_ > 0);
    --size_;
  }

  constexpr void clear() { size_ = 0; }

  // Shrinks to the first `count` elements, or grows by whatever the storage held before. Halts above capacity.
  constexpr void resize(std::size_t count) {
    Check(count <= kCapacity);
    size_ = count;
  }

  constexpr T& operator[](std::size_t i) {
    DebugCheck(i < size_);
    return items_[i];
  }
  constexpr const T& operator[](std::size_t i) const {
    DebugCheck(i < size_);
    return items_[i];
  }
  constexpr T& front() { return (*this)[0]; }
  constexpr const T& front() const { return (*this)[0]; }
  constexpr T& back() { return (*this)[size_ - 1]; }
  constexpr const T& back() const { return (*this)[size_ - 1]; }

  constexpr T* data() { return items_.data(); }
  constexpr const T* data() const { return items_.data(); }
  constexpr T* begin() { return items_.data(); }
  constexpr const T* begin() const { return items_.data(); }
  constexpr T* end() { return items_.data() + size_; }
  constexpr const T* end() const { return items_.data() + size_; }

 private:
  std::array<T, kCapacity> items_{};
  std::size_t size_ = 0;
};

}  // namespace wirepose

#endif  // WIREPOSE_BASE_FIXED_VECTOR_H_
