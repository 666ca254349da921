// The way from the vision thread to the publisher's thread. A stalled network never delays a frame.
#ifndef WIREPOSE_PUBLISH_OUTBOX_H_
#define WIREPOSE_PUBLISH_OUTBOX_H_

#include <atomic>
#include <cstdint>
#include <semaphore>

#include "base/memory_pool.h"
#include "base/spsc_queue.h"
#include "publish/reports.h"

namespace wirepose {

// Reports wait in blocks of a fixed pool; their addresses go through a wait-free queue. When no
// block is free, the newest report is given up and counted: those already waiting are at most
// kQueueCapacity frames old.
//
// Threads: Offer on one thread (vision), the rest on one other (publisher); the counters on any.
class Outbox {
 public:
  // As deep as the writers' history: more could not be delivered anyway.
  static constexpr std::size_t kQueueCapacity = 4;

  // Copies the report; false when it had to be given up. Neither blocks nor allocates.
  bool Offer(const FrameReport& report);
  bool Offer(const HealthReport& report);
  // Makes Wait return although nothing was offered.
  void Wake() { ready_.release(); }

  // Blocks until something has been offered since the last Wait. May return early: take until there
  // is nothing.
  void Wait() { ready_.acquire(); }
  // The oldest frame report, or nullptr. The caller owns it until Release.
  [[nodiscard]] const FrameReport* TakeFrame();
  void Release(const FrameReport* report);
  [[nodiscard]] bool TakeHealth(HealthReport& report) { return health_.try_pop(report); }

  [[nodiscard]] std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }
  // Most reports ever held at once, the one being written included, and how many can be.
  [[nodiscard]] std::size_t high_water() const { return pool_.high_water(); }
  [[nodiscard]] std::size_t capacity() const { return pool_.capacity(); }

 private:
  // One more than wait in the queue: the one being written.
  StaticMemoryPool<sizeof(FrameReport), kQueueCapacity + 1, alignof(FrameReport)> pool_;
  SpscQueue<FrameReport*, kQueueCapacity> frames_;
  SpscQueue<HealthReport, 2> health_;
  std::counting_semaphore<> ready_{0};
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_OUTBOX_H_
