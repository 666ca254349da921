// The stereo camera as the robot program sees it. One backend a room: replay, simulated, libcamera.
//
// Calls are legal in this order (anything else returns kWrongState and changes nothing):
//
//   closed --Open--> open --Start--> streaming --Stop--> open --Close--> closed
//                                    streaming: AcquireFrame any number of times
//
// Thread rule: one thread at a time calls; a lease may be released on another thread.
#ifndef WIREPOSE_HAL_STEREO_CAMERA_H_
#define WIREPOSE_HAL_STEREO_CAMERA_H_

#include <chrono>
#include <cstdint>
#include <string_view>
#include <utility>

#include "base/image_view.h"
#include "base/result.h"
#include "base/time.h"
#include "geometry/camera.h"

namespace wirepose::hal {

enum class [[nodiscard]] CameraError : std::uint8_t{
    kOk,
    kWrongState,    // the call is not legal now, see the diagram above
    kNotFound,      // no such camera, folder or scenario
    kBadData,       // calibration or data set malformed; detail() says where
    kUnsupported,   // the camera cannot give what the configuration asks for
    kTimeout,       // no frame within the time given; the stream goes on
    kNoBuffer,      // every buffer is leased: release one
    kEndOfStream,   // a recorded or simulated feed is over; Stop is the only legal call
    kDisconnected,  // the device is gone; AcquireFrame may be called again to wait for its return
};
const char* Describe(CameraError error);

// What is wrong with a frame that did arrive. Which fields are valid:
//   kGood           all
//   kImageMissing   sequence and capture time; images are empty
//   kImageDamaged   all, but the pixels must not be trusted (wrong size, torn, undecodable)
//   kNotSynchronous all, but left and right were exposed at different times
enum class FrameStatus : std::uint8_t { kGood, kImageMissing, kImageDamaged, kNotSynchronous };
const char* Describe(FrameStatus status);

struct StereoFrame {
  FrameStatus status = FrameStatus::kGood;
  std::uint64_t sequence = 0;  // counts captures, from 0; a gap means lost frames
  CaptureTime capture_time{};  // middle of the left exposure
  std::chrono::nanoseconds right_minus_left{0};
  ImageView left, right;  // 8 bit grey, raw (unrectified); owned by the camera until the lease ends
};

class StereoCamera;

// The right to read one frame's buffers. Move-only; its destructor returns the buffers to the camera. Must not outlive
// the camera.
class [[nodiscard]] FrameLease {
 public:
  FrameLease() = default;
  FrameLease(FrameLease&& other) noexcept { *this = std::move(other); }
  FrameLease& operator=(FrameLease&& other) noexcept;
  FrameLease(const FrameLease&) = delete;
  FrameLease& operator=(const FrameLease&) = delete;
  ~FrameLease() { Release(); }

  [[nodiscard]] const StereoFrame& frame() const { return frame_; }
  [[nodiscard]] const StereoFrame* operator->() const { return &frame_; }
  [[nodiscard]] bool valid() const { return camera_ != nullptr; }
  // Returns the buffers now. Idempotent.
  void Release();

 private:
  friend class StereoCamera;
  FrameLease(StereoCamera* camera, std::uint32_t buffer, const StereoFrame& frame)
      : camera_(camera), buffer_(buffer), frame_(frame) {}

  StereoCamera* camera_ = nullptr;
  std::uint32_t buffer_ = 0;
  StereoFrame frame_;
};

// Non-virtual interface: the state machine is enforced here, once for all backends.
class StereoCamera {
 public:
  virtual ~StereoCamera() = default;
  StereoCamera(const StereoCamera&) = delete;
  StereoCamera& operator=(const StereoCamera&) = delete;

  // Finds the device or data and reads the calibration. All memory is allocated here.
  CameraError Open();
  CameraError Start();
  // Waits for the next frame, at most `timeout`. A frame of any FrameStatus is a success.
  Result<FrameLease, CameraError> AcquireFrame(std::chrono::nanoseconds timeout);
  // Every lease must have ended. Idempotent.
  CameraError Stop();
  CameraError Close();

  // Valid from a successful Open on.
  [[nodiscard]] const StereoCalibration& calibration() const { return calibration_; }
  // File, place and remedy of the last error, or why the frame just acquired is not kGood, in one line; else empty.
  // Valid until the next call.
  [[nodiscard]] std::string_view detail() const { return DoDetail(); }
  // Short name of the backend for logs and health: "replay", "simulated", "libcamera".
  [[nodiscard]] std::string_view name() const { return DoName(); }

 protected:
  StereoCamera() = default;
  struct Captured {
    StereoFrame frame;
    std::uint32_t buffer = 0;
  };

 private:
  friend class FrameLease;
  enum class State : std::uint8_t { kClosed, kOpen, kStreaming };

  virtual CameraError DoOpen(StereoCalibration& calibration) = 0;
  virtual CameraError DoStart() = 0;
  virtual Result<Captured, CameraError> DoAcquire(std::chrono::nanoseconds timeout) = 0;
  virtual void DoRelease(std::uint32_t buffer) = 0;
  virtual CameraError DoStop() = 0;
  virtual void DoClose() = 0;
  [[nodiscard]] virtual std::string_view DoDetail() const = 0;
  [[nodiscard]] virtual std::string_view DoName() const = 0;

  State state_ = State::kClosed;
  StereoCalibration calibration_;
};

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_STEREO_CAMERA_H_
