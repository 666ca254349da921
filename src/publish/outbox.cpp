#include "publish/outbox.h"

namespace wirepose {

void Outbox::Offer(const FrameReport& report) {
  if (frames_.Put(report)) dropped_.fetch_add(1, std::memory_order_relaxed);
  ready_.release();
}

void Outbox::Offer(const SceneReport& scene) {
  scenes_.Put(scene);
  ready_.release();
}

void Outbox::Offer(const HealthReport& report) {
  health_.Put(report);
  ready_.release();
}

bool Outbox::Offer(const CommandAnswer& answer) {
  if (!answers_.try_push(answer)) return false;
  ready_.release();
  return true;
}

const FrameReport* Outbox::TakeFrame(std::uint64_t& dropped) {
  std::uint64_t number = 0;
  const FrameReport* const report = frames_.Take(number);
  if (report != nullptr) dropped = number - taken_++;
  return report;
}

const SceneReport* Outbox::TakeScene() {
  std::uint64_t number = 0;
  return scenes_.Take(number);
}

const HealthReport* Outbox::TakeHealth() {
  std::uint64_t number = 0;
  return health_.Take(number);
}

}  // namespace wirepose
