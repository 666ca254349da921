#include "app/service.h"

#ifdef WIREPOSE_SYSTEMD
#include <systemd/sd-daemon.h>
#endif

namespace wirepose::app {
namespace {

void Notify([[maybe_unused]] const std::string& text) {
#ifdef WIREPOSE_SYSTEMD
  // Fails when nobody listens: the program runs without systemd as well.
  (void)sd_notify(0, text.c_str());
#endif
}

}  // namespace

Service::Service() {
#ifdef WIREPOSE_SYSTEMD
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(0, &period_us) > 0) watchdog_period_ = std::chrono::microseconds(period_us);
#endif
}

void Service::Ready(const std::string& status) { Notify("READY=1\nSTATUS=" + status); }

void Service::Alive(Clock::time_point now) {
  if (!watchdog_period_) return;
  if (last_alive_ && now - *last_alive_ < *watchdog_period_ / 4) return;
  last_alive_ = now;
  Notify("WATCHDOG=1");
}

void Service::Stopping() { Notify("STOPPING=1"); }

}  // namespace wirepose::app
