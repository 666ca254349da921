// Keeps the health report and says when it is due.
#ifndef WIREPOSE_APP_HEALTH_MONITOR_H_
#define WIREPOSE_APP_HEALTH_MONITOR_H_

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/stereo_camera.h"
#include "publish/reports.h"

namespace wirepose::app {

// Counts what happens to frames and camera. It reads no clock: the caller says what time it is. Not
// thread safe.
class HealthMonitor {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kPeriod{1};

  HealthMonitor(std::string_view camera, Clock::time_point started);

  // Every frame that arrived, first: finds frames that were lost before.
  void FrameArrived(const hal::StereoFrame& frame, std::string_view detail);
  // The frame was recognized, or the recognizer refused it.
  void FrameDone(const RecognitionStatistics& statistics);
  // What the frames so far say of the eyes.
  void RowsMeasured(const RowAlignment& rows) { report_.rows = rows; }
  void FrameFailed(std::uint64_t sequence, std::string_view reason);
  void CameraFailed(hal::CameraError error, std::string_view detail);
  // A good frame arrived and was not looked at, as commanded.
  void Paused();
  void Stopped();

  // True once state or camera status have changed since the last call of Sent, or a second has
  // passed.
  [[nodiscard]] bool Due(Clock::time_point now) const;
  // The report as of now; the caller fills in what it knows itself: stage times, queue, drops and
  // write errors.
  HealthReport& Report(Clock::time_point now);
  // The report has been accepted for publishing.
  void Sent(Clock::time_point now);

 private:
  void SetState(HealthState state, std::string_view status);
  void SetError(std::string_view text);

  HealthReport report_;
  const Clock::time_point started_;
  std::optional<Clock::time_point> sent_;
  HealthState sent_state_ = HealthState::kStarting;
  FixedText<64> sent_status_;
  std::uint64_t next_sequence_ = 0;
};

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_HEALTH_MONITOR_H_
