// The simulator as a camera. Host only: it links Embree.
#ifndef WIREPOSE_HAL_SIMULATED_SIMULATED_CAMERA_H_
#define WIREPOSE_HAL_SIMULATED_SIMULATED_CAMERA_H_

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/stereo_camera.h"

namespace wirepose::hal {

struct SimulatedConfig {
  std::filesystem::path scenario_path;  // sim/scenario_file.h; empty: a kitchen with some objects
  int scene = 0;                        // of the scenario's
  std::uint64_t frame_count = 30;       // length of the stream; 0: endless
  std::filesystem::path mesh_dir;       // the objects: sim/target_mesh.h says what is read
  // When set, these hold instead of the scenario's: see sim/scenario_spec.h.
  std::optional<std::uint64_t> seed;
  std::optional<double> frame_rate_hz;   // of the capture stamps and of the camera's motion, 1..1000
  std::optional<int> samples_per_pixel;  // 4, 9, 16, 25 or 36
  // Folder for rendered frames; when set, frames that are in it are not rendered again, and none
  // comes before its time. Empty: frames come as fast as they are rendered, unless they loop.
  std::filesystem::path cache_path;
  // When not 0, only that many frames are rendered (at most kMaxLoopFrames) and given out over and over from memory,
  // each at its time; sequence numbers and capture times go on. What a fault of the scenario changes in the rendering
  // is rendered anew.
  std::uint64_t loop_frames = 0;
  // calib.yaml of the rig to simulate, see hal/dataset/calibration_file.h; empty: the scenario's.
  std::filesystem::path calibration_path;
  // When set, one JSON object a line for every frame, written before the frame is given out:
  // {"sequence":0,"capture_time_ns":0,"objects":[{"obj_id":1,"name":"parcel_box","R":[9],"t":[3],"visib_fract":0.9}]}
  // R (row-major) and t [m] map the model to the raw left camera.
  std::filesystem::path truth_path;
};

struct SimulatedObject {
  int obj_id = 0;
  std::string name;
  Pose T_camera_model;     // raw left camera; metres
  double visib_fract = 0;  // as BOP defines it
};

struct SimulatedTruth {
  std::uint64_t sequence = 0;
  CaptureTime capture_time{};
  std::vector<SimulatedObject> objects;
};

// A camera that moves through one of sim/'s scenes. A thread of its own renders ahead into four
// buffers, allocated by Open. Capture times are sequence / frame rate; the same configuration gives
// the same frames, stamps and bytes each time; Start begins at the first frame. Nothing is lost
// unless the scenario says so: its faults (sim/scenario_spec.h) happen here.
//
// Open: kNotFound (no mesh folder), kBadData (no usable mesh, malformed scenario or calibration),
// kUnsupported (configuration, or no mesh is small enough). Start: kBadData (truth file not
// writable). AcquireFrame: kTimeout (still rendering), kNoBuffer, kEndOfStream, kDisconnected (once
// for each frame that the scenario's `disconnect` swallows), kBadData (truth file or cache cannot be
// written). Stop waits for the frame in the making, some seconds.
class SimulatedCamera final : public StereoCamera {
 public:
  static constexpr std::uint32_t kBuffers = 4;
  static constexpr std::uint64_t kMaxLoopFrames = 1000;  // 600 MB at 640x480

  explicit SimulatedCamera(SimulatedConfig config);
  ~SimulatedCamera() override;

  // The truth of one of the last 64 frames that were rendered since Start; nothing for any other.
  // Any thread.
  [[nodiscard]] std::optional<SimulatedTruth> Truth(std::uint64_t sequence) const;

 private:
  class Worker;

  CameraError DoOpen(StereoCalibration& calibration) override;
  CameraError DoStart() override;
  Result<Captured, CameraError> DoAcquire(std::chrono::nanoseconds timeout) override;
  void DoRelease(std::uint32_t buffer) override;
  CameraError DoStop() override;
  void DoClose() override;
  [[nodiscard]] std::string_view DoDetail() const override { return detail_; }
  [[nodiscard]] std::string_view DoName() const override { return "simulated"; }

  SimulatedConfig config_;
  std::unique_ptr<Worker> worker_;  // while open
  std::string detail_;
};

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_SIMULATED_SIMULATED_CAMERA_H_
