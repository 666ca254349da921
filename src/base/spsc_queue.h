// A bounded queue between one producing and one consuming thread.
#ifndef WIREPOSE_BASE_SPSC_QUEUE_H_
#define WIREPOSE_BASE_SPSC_QUEUE_H_

#include <array>
#include <atomic>
#include <cstddef>
#include <type_traits>

namespace wirepose {

// First in, first out; storage in the object. Wait-free: every call ends after a fixed number of
// steps, whatever the other thread does. Each side keeps its index and its last view of the other's
// index on a cache line of its own, so that in the common case a call touches no line the other
// side writes (Rigtorp's SPSCQueue describes the technique).
//
// Threads: one thread may call try_push, one try_pop; size() and empty() may be called by both and
// are exact only when the other side rests. Elements are copied.
template <typename T, std::size_t kCapacity>
class SpscQueue {
  static_assert(kCapacity > 0);
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  SpscQueue() = default;
  SpscQueue(const SpscQueue&) = delete;
  SpscQueue& operator=(const SpscQueue&) = delete;

  static constexpr std::size_t capacity() { return kCapacity; }

  // False, and no change, when full.
  [[nodiscard]] bool try_push(const T& value) {
    const std::size_t tail = producer_.own.load(std::memory_order_relaxed);
    const std::size_t next = Next(tail);
    if (next == producer_.other) {
      producer_.other = consumer_.own.load(std::memory_order_acquire);
      if (next == producer_.other) return false;
    }
    slots_[tail] = value;
    producer_.own.store(next, std::memory_order_release);
    return true;
  }

  // False, and `value` unchanged, when empty.
  [[nodiscard]] bool try_pop(T& value) {
    const std::size_t head = consumer_.own.load(std::memory_order_relaxed);
    if (head == consumer_.other) {
      consumer_.other = producer_.own.load(std::memory_order_acquire);
      if (head == consumer_.other) return false;
    }
    value = slots_[head];
    consumer_.own.store(Next(head), std::memory_order_release);
    return true;
  }

  [[nodiscard]] std::size_t size() const {
    const std::size_t head = consumer_.own.load(std::memory_order_acquire);
    const std::size_t tail = producer_.own.load(std::memory_order_acquire);
    return tail >= head ? tail - head : tail + kSlots - head;
  }
  [[nodiscard]] bool empty() const { return size() == 0; }

 private:
  static constexpr std::size_t kSlots = kCapacity + 1;  // one stays empty: it tells full from empty
  // 64 bytes on x86-64 and the Cortex-A and -M cores that have a cache; std's constant varies with
  // compiler flags.
  static constexpr std::size_t kCacheLine = 64;

  static constexpr std::size_t Next(std::size_t i) { return i + 1 == kSlots ? 0 : i + 1; }

  struct alignas(kCacheLine) Side {
    std::atomic<std::size_t> own{0};  // written by this side only
    std::size_t other = 0;            // this side's last view of the other side's index
  };

  Side producer_;
  Side consumer_;
  alignas(kCacheLine) std::array<T, kSlots> slots_{};
};

}  // namespace wirepose

#endif  // WIREPOSE_BASE_SPSC_QUEUE_H_
