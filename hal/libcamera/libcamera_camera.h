// Two cameras, or one that gives both images side by side, through libcamera.
#ifndef WIREPOSE_HAL_LIBCAMERA_LIBCAMERA_CAMERA_H_
#define WIREPOSE_HAL_LIBCAMERA_LIBCAMERA_CAMERA_H_

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "hal/libcamera/camera_stream.h"
#include "hal/libcamera/libcamera_config.h"
#include "hal/stereo_camera.h"

namespace wirepose::hal {

// Frames are paired by capture time (see frame_pairing.h); the newest pair is given, older ones are counted as lost by
// their sequence. A luma plane is used in place, packed formats are copied into buffers of ours. AcquireFrame and
// release allocate nothing of ours. When a camera goes, AcquireFrame returns kDisconnected at once and looks for it,
// twice a second at most, until all are back; sequence numbers go on. Leases must end before that search: their buffers
// go with the camera.
//
// Open: kBadData (calibration), kNotFound (no such camera), kUnsupported (format or size). Start: kUnsupported.
// AcquireFrame: kTimeout, kNoBuffer (3 leases are out), kDisconnected.
class LibcameraCamera final : public StereoCamera, private StreamListener {
 public:
  explicit LibcameraCamera(LibcameraConfig config);
  ~LibcameraCamera() override;

 private:
  static constexpr std::uint32_t kMaxLeases = kCameraBuffers - 1;  // one buffer stays with the camera

  struct Lease {
    bool taken = false;
    FramePair pair;
    std::array<std::vector<std::uint8_t>, 2> copy;  // of packed formats
  };

  CameraError DoOpen(StereoCalibration& calibration) override;
  CameraError DoStart() override;
  Result<Captured, CameraError> DoAcquire(std::chrono::nanoseconds timeout) override;
  void DoRelease(std::uint32_t buffer) override;
  CameraError DoStop() override;
  void DoClose() override;
  [[nodiscard]] std::string_view DoDetail() const override { return detail_; }
  [[nodiscard]] std::string_view DoName() const override { return "libcamera"; }

  void FrameFinished(std::size_t eye, const EyeFrame& frame) override;
  void CameraGone() override;

  CameraError Fail(CameraError error, std::string detail);
  CameraError OpenAll();
  void CloseAll();
  CameraError OpenStreams();
  CameraError StartStreams();
  [[nodiscard]] std::shared_ptr<libcamera::Camera> Find(const std::string& name, std::string& error) const;
  bool Reconnect();
  std::optional<FramePair> WaitForPair(std::chrono::nanoseconds timeout);
  void Requeue(std::size_t eye, std::uint32_t slot);
  [[nodiscard]] std::optional<std::uint32_t> FreeLease();
  [[nodiscard]] bool AnyLease();
  void Describe(const FramePair& pair, StereoFrame& frame);
  void FillImages(Lease& lease, StereoFrame& frame);
  ImageView Image(std::size_t eye, Lease& lease);

  LibcameraConfig config_;
  StereoCalibration rig_;
  std::unique_ptr<libcamera::CameraManager> manager_;
  std::vector<std::unique_ptr<CameraStream>> streams_;  // two, or one side by side
  std::string detail_;
  std::uint64_t sequence_base_ = 0;  // what is added to the camera's count; grows when it begins anew
  std::uint64_t next_sequence_ = 0;
  std::chrono::steady_clock::time_point next_search_;  // for a camera that is gone

  std::mutex mutex_;  // of what libcamera's thread shares: all below
  std::condition_variable changed_;
  std::array<Lease, kMaxLeases> leases_;  // only `taken` is shared
  FramePairing pairing_;
  bool gone_ = false;
};

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_LIBCAMERA_LIBCAMERA_CAMERA_H_
