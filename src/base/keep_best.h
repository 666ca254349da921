// Overflow with manners: a full list keeps its best elements and says how many it dropped.
#ifndef WIREPOSE_BASE_KEEP_BEST_H_
#define WIREPOSE_BASE_KEEP_BEST_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/fixed_vector.h"

namespace wirepose {

// Collects any number of elements and keeps the `kCapacity` best. `Better(a, b)` must be a strict total order, ties
// broken by id, so that the outcome does not depend on the standard library. Push is O(log kCapacity).
template <typename T, std::size_t kCapacity, typename Better>
class KeepBest {
 public:
  void clear() {
    items_.clear();
    dropped_ = 0;
  }

  void Push(const T& value) {
    if (items_.try_push_back(value)) {
      std::push_heap(items_.begin(), items_.end(), Better{});
      return;
    }
    ++dropped_;
    // The heap's front is its worst element, because "less" means better.
    if (!Better{}(value, items_.front())) return;
    std::pop_heap(items_.begin(), items_.end(), Better{});
    items_.back() = value;
    std::push_heap(items_.begin(), items_.end(), Better{});
  }

  // Counts elements that were given up before they were made.
  void CountDropped(std::uint32_t count) { dropped_ += count; }

  // True when `value` would be kept: lets callers skip the work of making it.
  [[nodiscard]] bool WouldKeep(const T& value) const { return !items_.full() || Better{}(value, items_.front()); }

  // Best first. The collection stays valid only until the next Push. O(n log n).
  FixedVector<T, kCapacity>& Sorted() {
    std::sort(items_.begin(), items_.end(), Better{});
    return items_;
  }

  // In the order that the last Sorted() or Push() left.
  [[nodiscard]] std::span<const T> items() const { return {items_.begin(), items_.end()}; }
  [[nodiscard]] std::size_t size() const { return items_.size(); }
  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }

 private:
  FixedVector<T, kCapacity> items_;
  std::uint32_t dropped_ = 0;
};

}  // namespace wirepose

#endif  // WIREPOSE_BASE_KEEP_BEST_H_
