// KeepBest for lists that are offered many times what they hold.
#ifndef WIREPOSE_BASE_KEEP_BEST_OF_MANY_H_
#define WIREPOSE_BASE_KEEP_BEST_OF_MANY_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "base/fixed_vector.h"

namespace wirepose {

// Keeps the `kCapacity` best of any number of elements, as KeepBest does, in half as much room again: when that is full
// the worse third is thrown out at once. Push is O(1) on average, where KeepBest's heap pays O(log kCapacity) and a
// misprediction a level. `Better` must be a strict total order: then what is kept depends on nothing else.
template <typename T, std::size_t kCapacity, typename Better>
class KeepBestOfMany {
 public:
  void clear() {
    items_.clear();
    worst_.reset();
    dropped_ = 0;
  }

  void Push(const T& value) {
    if (!MayKeep(value)) {
      ++dropped_;
      return;
    }
    items_.push_back(value);
    if (items_.full()) Cut();
  }

  // Counts elements that were given up before they were made.
  void CountDropped(std::uint32_t count) { dropped_ += count; }

  // False when `value` would certainly be dropped.
  [[nodiscard]] bool MayKeep(const T& value) const { return !worst_ || Better{}(value, *worst_); }

  // What an element must be better than; nothing before the list was full.
  [[nodiscard]] const std::optional<T>& worst() const { return worst_; }

  // Best first. The collection stays valid only until the next Push. O(n log n).
  std::span<const T> Sorted() {
    if (items_.size() > kCapacity) Cut();
    std::sort(items_.begin(), items_.end(), Better{});
    return items();
  }

  // As the last Sorted() left them.
  [[nodiscard]] std::span<const T> items() const { return {items_.begin(), items_.end()}; }

  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }

 private:
  void Cut() {
    const auto end = items_.begin() + static_cast<std::ptrdiff_t>(kCapacity);
    std::nth_element(items_.begin(), end - 1, items_.end(), Better{});
    dropped_ += static_cast<std::uint32_t>(items_.end() - end);
    worst_ = *(end - 1);
    items_.resize(kCapacity);
  }

  FixedVector<T, kCapacity + kCapacity / 2> items_;
  std::optional<T> worst_;
  std::uint32_t dropped_ = 0;
};

}  // namespace wirepose

#endif  // WIREPOSE_BASE_KEEP_BEST_OF_MANY_H_
