// The newest few of what one thread makes, for one other thread that may be slow: keep-last between threads.
#ifndef WIREPOSE_PUBLISH_LATEST_RING_H_
#define WIREPOSE_PUBLISH_LATEST_RING_H_

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace wirepose {

// Keeps the newest kDepth items; the oldest that was not taken makes room for a new one. Storage in the object: kDepth
// items wait, one is being written and one is being read.
//
// Threads: one thread puts, one takes. Put is wait-free: it never waits for the taker, however slow that is. Take
// begins again when an item is replaced under its hands, so it may only be slow while the putter is fast.
template <typename T, std::size_t kDepth>
class LatestRing {
  static_assert(kDepth > 0 && kDepth < 250);
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  LatestRing() {
    for (auto& state : free_) state.store(true, std::memory_order_relaxed);
  }
  LatestRing(const LatestRing&) = delete;
  LatestRing& operator=(const LatestRing&) = delete;

  static constexpr std::size_t depth() { return kDepth; }

  // Copies the item in. True when an older one, never taken, was given up for it.
  bool Put(const T& item) {
    const std::size_t block = FreeBlock();
    blocks_[block] = item;
    const std::uint64_t old = places_[put_ % kDepth].exchange(Pack(put_, block), std::memory_order_acq_rel);
    ++put_;
    if (old != kEmpty) free_[BlockOf(old)].store(true, std::memory_order_release);
    NoteUse();
    return old != kEmpty;
  }

  // The oldest item, which stays valid until Release, and its number in the order of Put; nullptr when there is none.
  // At most one may be held.
  const T* Take(std::uint64_t& number) {
    // One look over the places is not one moment: the putter may fill a place already passed, then one still ahead. But
    // all that is older than what one look found was there before the next began: found twice, it is the oldest.
    for (std::uint64_t found = Oldest(); found != kEmpty;) {
      const std::uint64_t again = Oldest();
      // The exchange fails when the putter has replaced the item.
      if (again == found && PlaceOf(found).compare_exchange_strong(found, kEmpty, std::memory_order_acq_rel)) {
        number = NumberOf(again);
        return &blocks_[BlockOf(again)];
      }
      found = again;
    }
    return nullptr;
  }
  void Release(const T* item) {
    free_[static_cast<std::size_t>(item - blocks_.data())].store(true, std::memory_order_release);
  }

  // Most items that ever waited at once.
  [[nodiscard]] std::size_t high_water() const { return high_water_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kBlocks = kDepth + 2;
  static constexpr std::uint64_t kEmpty = 0;
  static constexpr int kBlockBits = 8;

  // The number above the block, so that the order of places is the order of numbers.
  static std::uint64_t Pack(std::uint64_t number, std::size_t block) { return ((number + 1) << kBlockBits) | block; }
  static std::size_t BlockOf(std::uint64_t place) {
    return static_cast<std::size_t>(place & ((std::uint64_t{1} << kBlockBits) - 1));
  }
  static std::uint64_t NumberOf(std::uint64_t place) { return (place >> kBlockBits) - 1; }
  std::atomic<std::uint64_t>& PlaceOf(std::uint64_t place) { return places_[NumberOf(place) % kDepth]; }

  // The oldest in one look over the places.
  [[nodiscard]] std::uint64_t Oldest() const {
    std::uint64_t oldest = kEmpty;
    for (const auto& place : places_) {
      const std::uint64_t found = place.load(std::memory_order_acquire);
      if (found != kEmpty && (oldest == kEmpty || found < oldest)) oldest = found;
    }
    return oldest;
  }

  // There always is one: at most kDepth wait and one is being read.
  std::size_t FreeBlock() {
    for (std::size_t i = 0;; i = (i + 1) % kBlocks) {
      if (free_[i].exchange(false, std::memory_order_acquire)) return i;
    }
  }
  void NoteUse() {
    std::size_t waiting = 0;
    for (const auto& place : places_) waiting += place.load(std::memory_order_relaxed) != kEmpty ? 1 : 0;
    if (waiting > high_water()) high_water_.store(waiting, std::memory_order_relaxed);
  }

  std::array<T, kBlocks> blocks_{};
  std::array<std::atomic<bool>, kBlocks> free_;
  std::array<std::atomic<std::uint64_t>, kDepth> places_{};
  std::uint64_t put_ = 0;  // the putter's
  std::atomic<std::size_t> high_water_{0};
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_LATEST_RING_H_
