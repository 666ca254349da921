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

RobotLoop::RobotLoop(const RobotParts& parts, const RobotLoopConfig& config)
    : camera_(parts.camera),
      recognizer_(parts.recognizer),
      publisher_(parts.publisher),
      commands_(parts.commands),
      service_(parts.service),
      config_(config),
      health_(parts.camera.name(), HealthMonitor::Clock::now()) {
  report_.models = LabelsOf(recognizer_.models(), recognizer_.searched());
}

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
    HandleCommands();
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

  report_.stamp = config_.stamps.StampOf(lease->capture_time);
  if (commands_.paused()) {
    health_.Paused();
    return;
  }
  timer_.FrameBegins();
  const RecognizerError error = ProcessTracked(recognizer_, config_.tracking ? &tracker_ : nullptr, lease->capture_time,
                                               lease->left, lease->right, &timer_, report_.result);
  timer_.FrameEnds();
  report_.sequence = lease->sequence;
  report_.capture_time = lease->capture_time;
  if (error == RecognizerError::kOk) PublishImage(lease->left);
  lease.Release();
  if (error != RecognizerError::kOk) {
    health_.FrameFailed(report_.sequence, Describe(error));
    return;
  }
  health_.FrameDone(report_.result.statistics);
  alignment_.Update(recognizer_.camera(), recognizer_.row_offsets());
  health_.RowsMeasured(alignment_.alignment());
  publisher_.Publish(report_);  // counts what it has to give up
  PublishScene();
}

void RobotLoop::PublishScene() {
  if (!publisher_.SceneWanted()) return;
  scene_.stamp = report_.stamp;
  FillScene(recognizer_, report_.result, scene_);
  publisher_.Publish(scene_);
}

void RobotLoop::PublishImage(const ImageView& left) {
  if (!publisher_.ImageWanted()) return;
  image_.stamp = report_.stamp;
  FillImage(left, image_);
  publisher_.Publish(image_);
}

void RobotLoop::HandleCommands() {
  Command command;
  while (publisher_.TakeCommand(command)) {
    const CommandAnswer answer = commands_.Execute(command);
    publisher_.Answer(answer);
    if (answer.accepted && command.action == CommandAction::kReloadModels) tracker_.Forget();
    report_.models = LabelsOf(recognizer_.models(), recognizer_.searched());
  }
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
  report.stamp = config_.stamps.StampOfNow(report_.stamp);
  report.models = report_.models;
  publisher_.Publish(report);
  health_.Sent(now);
}

}  // namespace wirepose::app
