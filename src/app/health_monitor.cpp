#include "app/health_monitor.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>

namespace wirepose::app {
namespace {

// Highest use and sum of drops; the sum stays at its largest number instead of beginning anew.
void Accumulate(const ListUse& frame, ListUse& total) {
  total.used = std::max(total.used, frame.used);
  total.capacity = frame.capacity;
  const std::uint32_t room = std::numeric_limits<std::uint32_t>::max() - total.dropped;
  total.dropped += std::min(room, frame.dropped);
}

void Accumulate(const RecognitionStatistics& frame, RecognitionStatistics& total) {
  for (const RecognitionList& list : kRecognitionLists) Accumulate(frame.*list.use, total.*list.use);
}

// Both parts on one line, without heap: a camera that is lost shall not cost the vision thread any.
class Line {
 public:
  Line(std::string_view what, std::string_view detail) {
    const int size = std::snprintf(text_.data(), text_.size(), "%.*s%s%.*s", static_cast<int>(what.size()), what.data(),
                                   detail.empty() ? "" : ": ", static_cast<int>(detail.size()), detail.data());
    size_ = std::min(static_cast<std::size_t>(std::max(size, 0)), text_.size() - 1);
  }
  operator std::string_view() const { return {text_.data(), size_}; }  // NOLINT(google-explicit-constructor)

 private:
  std::array<char, 512> text_;  // more than the report keeps
  std::size_t size_ = 0;
};

// "frame N".
class FrameName {
 public:
  explicit FrameName(std::uint64_t sequence) {
    std::snprintf(text_.data(), text_.size(), "frame %llu", static_cast<unsigned long long>(sequence));
  }
  operator std::string_view() const { return text_.data(); }  // NOLINT(google-explicit-constructor)

 private:
  std::array<char, 32> text_;
};

}  // namespace

HealthMonitor::HealthMonitor(std::string_view camera, Clock::time_point started) : started_(started) {
  report_.camera = camera;
  report_.camera_status = "ok";
}

void HealthMonitor::FrameArrived(const hal::StereoFrame& frame, std::string_view detail) {
  FrameCounts& frames = report_.frames;
  if (frame.sequence > next_sequence_) frames.late += frame.sequence - next_sequence_;
  next_sequence_ = frame.sequence + 1;
  switch (frame.status) {
    case hal::FrameStatus::kGood:
      return;  // counted by FrameDone or FrameFailed
    case hal::FrameStatus::kImageMissing:
      ++frames.missing;
      break;
    case hal::FrameStatus::kImageDamaged:
      ++frames.damaged;
      break;
    case hal::FrameStatus::kNotSynchronous:
      ++frames.not_synchronous;
      break;
  }
  SetState(HealthState::kBadFrames, hal::Describe(frame.status));
  const Line what(FrameName(frame.sequence), hal::Describe(frame.status));
  SetError(Line(what, detail));
}

void HealthMonitor::FrameDone(const RecognitionStatistics& statistics) {
  ++report_.frames.good;
  Accumulate(statistics, report_.lists);
  SetState(HealthState::kRunning, "ok");
}

void HealthMonitor::FrameFailed(std::uint64_t sequence, std::string_view reason) {
  ++report_.frames.failed;
  SetState(HealthState::kBadFrames, reason);
  SetError(Line(FrameName(sequence), reason));
}

void HealthMonitor::CameraFailed(hal::CameraError error, std::string_view detail) {
  const bool timeout = error == hal::CameraError::kTimeout;
  SetState(timeout ? HealthState::kNoFrames : HealthState::kCameraLost, hal::Describe(error));
  SetError(Line(hal::Describe(error), detail));
}

void HealthMonitor::Paused() { SetState(HealthState::kPaused, "ok"); }

void HealthMonitor::Stopped() { SetState(HealthState::kStopped, report_.camera_status); }

bool HealthMonitor::Due(Clock::time_point now) const {
  return !sent_ || report_.state != sent_state_ || !(report_.camera_status == sent_status_) || now - *sent_ >= kPeriod;
}

HealthReport& HealthMonitor::Report(Clock::time_point now) {
  report_.uptime_ns =
      static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(now - started_).count());
  return report_;
}

void HealthMonitor::Sent(Clock::time_point now) {
  sent_ = now;
  sent_state_ = report_.state;
  sent_status_ = report_.camera_status;
}

void HealthMonitor::SetState(HealthState state, std::string_view status) {
  report_.state = state;
  // A copy first: `status` may be the very text that is assigned to.
  report_.camera_status = FixedText<64>(status);
}

void HealthMonitor::SetError(std::string_view text) { report_.last_error = text; }

}  // namespace wirepose::app
