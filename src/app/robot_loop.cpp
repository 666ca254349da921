#include "app/robot_loop.h"

#include <algorithm>
#include <string>
#include <thread>

#include "app/failure.h"

namespace wirepose::app {
namespace {

// Health, watchdog and signals are looked after between two waits for a frame.
constexpr std::chrono::nanoseconds kLongestWait = std::chrono::milliseconds(250);

// Between two attempts at a camera that is gone and says so without waiting.
constexpr std::chrono::milliseconds kRetryPause{100};

}  // namespace

RobotLoop::RobotLoop(hal::StereoCamera& camera, Recognizer& recognizer, Publisher& publisher, Service& service,
                     const RobotLoopConfig& config)
    : camera_(camera),
      recognizer_(recognizer),
      publisher_(publisher),
      service_(service),
      config_(config),
      health_(camera.name(), HealthMonitor::Clock::now()) {}

void RobotLoop::Run(const std::atomic<bool>& stop) {
  SendHealthIfDue();
  const std::chrono::nanoseconds wait = std::min(config_.frame_timeout, kLongestWait);
  waiting_since_ = HealthMonitor::Clock::now();
  bool more = true;
  while (more && !stop && (config_.max_frames == 0 || frames_ < config_.max_frames)) {
    Result<hal::FrameLease, hal::CameraError> lease = camera_.AcquireFrame(wait);
    if (lease) {
      HandleFrame(std::move(*lease));
      waiting_since_ = HealthMonitor::Clock::now();
    } else {
      more = HandleCameraError(lease.error());
    }
    SendHealthIfDue();
    service_.Alive(Service::Clock::now());
  }
  health_.Stopped();
  SendHealthIfDue();
}

void RobotLoop::HandleFrame(hal::FrameLease lease) {
  ++frames_;
  health_.FrameArrived(lease.frame(), camera_.detail());
  if (lease->status != hal::FrameStatus::kGood) return;

  timer_.FrameBegins();
  const RecognizerError error = recognizer_.Process(lease->left, lease->right, &timer_, report_.result);
  timer_.FrameEnds();
  report_.sequence = lease->sequence;
  report_.capture_time = lease->capture_time;
  lease.Release();
  if (error != RecognizerError::kOk) {
    health_.FrameFailed(report_.sequence, Describe(error));
    return;
  }
  health_.FrameDone(report_.result.statistics);
  publisher_.Publish(report_);  // counts what it has to drop
}

bool RobotLoop::HandleCameraError(hal::CameraError error) {
  switch (error) {
    case hal::CameraError::kEndOfStream:
      return false;
    case hal::CameraError::kDisconnected:
    case hal::CameraError::kNoBuffer:
      health_.CameraFailed(error, camera_.detail());
      std::this_thread::sleep_for(kRetryPause);
      return true;
    case hal::CameraError::kTimeout:
      if (HealthMonitor::Clock::now() - waiting_since_ >= config_.frame_timeout) {
        health_.CameraFailed(error, camera_.detail());
      }
      return true;
    default: {
      health_.CameraFailed(error, camera_.detail());
      SendHealthIfDue();
      const std::string detail(camera_.detail());
      throw WorkFailed(detail.empty() ? std::string("camera: ") + hal::Describe(error) : detail);
    }
  }
}

void RobotLoop::SendHealthIfDue() {
  const HealthMonitor::Clock::time_point now = HealthMonitor::Clock::now();
  if (!health_.Due(now)) return;
  HealthReport& report = health_.Report(now);
  report.stage_times = timer_.Summary();
  report.queue_high_water = static_cast<std::uint32_t>(publisher_.queue_high_water());
  report.queue_capacity = static_cast<std::uint32_t>(publisher_.queue_capacity());
  report.results_dropped = publisher_.results_dropped();
  report.write_errors = publisher_.write_errors();
  // When the queue is full the report stays due.
  if (publisher_.Publish(report)) health_.Sent(now);
}

}  // namespace wirepose::app
