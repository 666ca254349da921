#include "publish/outbox.h"

#include <new>

#include "base/check.h"

namespace wirepose {

bool Outbox::Offer(const FrameReport& report) {
  void* const block = pool_.Alloc();
  if (block != nullptr) {
    auto* const copy = new (block) FrameReport(report);
    copy->results_dropped = dropped();
    if (frames_.try_push(copy)) {
      ready_.release();
      return true;
    }
    Check(pool_.Free(block) == PoolStatus::kOk);
  }
  dropped_.fetch_add(1, std::memory_order_relaxed);
  return false;
}

bool Outbox::Offer(const HealthReport& report) {
  if (!health_.try_push(report)) return false;
  ready_.release();
  return true;
}

const FrameReport* Outbox::TakeFrame() {
  FrameReport* report = nullptr;
  return frames_.try_pop(report) ? report : nullptr;
}

void Outbox::Release(const FrameReport* report) {
  Check(pool_.Free(const_cast<FrameReport*>(report)) == PoolStatus::kOk);
}

}  // namespace wirepose
