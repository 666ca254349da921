// The loop of the robot program: a frame from the camera, through the recognizer, to the publisher.
#ifndef WIREPOSE_APP_ROBOT_LOOP_H_
#define WIREPOSE_APP_ROBOT_LOOP_H_

#include <atomic>
#include <chrono>
#include <cstdint>

#include "app/command_handler.h"
#include "app/health_monitor.h"
#include "app/service.h"
#include "app/stage_timer.h"
#include "app/stamp_clock.h"
#include "hal/stereo_camera.h"
#include "pipeline/recognizer.h"
#include "pipeline/row_alignment.h"
#include "pipeline/tracker.h"
#include "publish/publisher.h"

namespace wirepose::app {

struct RobotLoopConfig {
  std::chrono::nanoseconds frame_timeout;  // without a frame for that long: no_frames
  std::uint64_t max_frames = 0;            // frames of any status; 0: no end
  StampClock stamps{StampSource::kSystem, false};
  bool tracking = true;  // objects are followed over frames
};

// What the loop joins. All outlive it.
struct RobotParts {
  hal::StereoCamera& camera;
  Recognizer& recognizer;
  Publisher& publisher;
  CommandHandler& commands;
  Service& service;
};

// Run is called on one thread; allocates nothing while frames are good and no command comes.
class RobotLoop {
 public:
  RobotLoop(const RobotParts& parts, const RobotLoopConfig& config);

  // Runs on a streaming camera until `stop` is set, the feed is over or max_frames have come. A bad
  // frame, a time-out and a lost camera are reported on health, and the loop goes on. Throws
  // WorkFailed when the camera reports an error that waiting cannot mend.
  void Run(const std::atomic<bool>& stop);

  [[nodiscard]] std::uint64_t frames() const { return frames_; }

 private:
  void HandleFrame(hal::FrameLease lease);
  void HandleCommands();
  void PublishScene();
  void PublishImage(const ImageView& left);
  // False at the end of the feed.
  bool HandleCameraError(hal::CameraError error);
  void SendHealthIfDue();

  hal::StereoCamera& camera_;
  Recognizer& recognizer_;
  Publisher& publisher_;
  CommandHandler& commands_;
  Service& service_;
  const RobotLoopConfig config_;
  HealthMonitor health_;
  StageTimer timer_;
  AlignmentMonitor alignment_;
  Tracker tracker_;
  FrameReport report_;
  SceneReport scene_;
  ImageReport image_;
  HealthMonitor::Clock::time_point waiting_since_;  // the last thing the camera did
  std::uint64_t frames_ = 0;
};

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_ROBOT_LOOP_H_
