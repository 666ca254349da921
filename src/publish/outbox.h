// The way from the vision thread to the publisher's thread. A stalled network never delays a frame.
#ifndef WIREPOSE_PUBLISH_OUTBOX_H_
#define WIREPOSE_PUBLISH_OUTBOX_H_

#include <atomic>
#include <cstdint>
#include <semaphore>

#include "base/spsc_queue.h"
#include "publish/commands.h"
#include "publish/latest_ring.h"
#include "publish/reports.h"
#include "publish/scene_report.h"

namespace wirepose {

// Reports are kept last: when the publisher falls behind, the newest wait and the oldest are given up, as on the topics
// themselves. Answers to commands are never given up for newer ones.
//
// Threads: Offer on one thread (vision), the rest on one other (publisher); the counters and Wake on any. Offer neither
// blocks nor allocates.
class Outbox {
 public:
  // As deep as the writers' history: more could not be delivered anyway.
  static constexpr std::size_t kFrames = 4;
  static constexpr std::size_t kAnswers = 16;

  void Offer(const FrameReport& report);
  void Offer(const SceneReport& scene);
  void Offer(const HealthReport& report);
  // False when kAnswers wait already.
  [[nodiscard]] bool Offer(const CommandAnswer& answer);
  // Makes Wait return although nothing was offered.
  void Wake() { ready_.release(); }

  // Blocks until something has been offered since the last Wait. May return early: take until there is nothing.
  void Wait() { ready_.acquire(); }
  // The oldest that waits, or nullptr. Valid until Release; hold one of a kind at a time. `dropped`: how many frame
  // reports were given up before this one, since the start.
  [[nodiscard]] const FrameReport* TakeFrame(std::uint64_t& dropped);
  [[nodiscard]] const SceneReport* TakeScene();
  [[nodiscard]] const HealthReport* TakeHealth();
  void Release(const FrameReport* report) { frames_.Release(report); }
  void Release(const SceneReport* scene) { scenes_.Release(scene); }
  void Release(const HealthReport* report) { health_.Release(report); }
  [[nodiscard]] bool TakeAnswer(CommandAnswer& answer) { return answers_.try_pop(answer); }

  // Frame reports given up since the start.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }
  // Most frame reports that ever waited at once, and how many can.
  [[nodiscard]] std::size_t high_water() const { return frames_.high_water(); }
  [[nodiscard]] std::size_t capacity() const { return kFrames; }

 private:
  LatestRing<FrameReport, kFrames> frames_;
  LatestRing<SceneReport, 1> scenes_;
  LatestRing<HealthReport, 1> health_;
  SpscQueue<CommandAnswer, kAnswers> answers_;
  std::counting_semaphore<> ready_{0};
  std::atomic<std::uint64_t> dropped_{0};
  std::uint64_t taken_ = 0;  // frame reports; the publisher's
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_OUTBOX_H_
