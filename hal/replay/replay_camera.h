// A recorded data set as a camera.
#ifndef WIREPOSE_HAL_REPLAY_REPLAY_CAMERA_H_
#define WIREPOSE_HAL_REPLAY_REPLAY_CAMERA_H_

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hal/buffer_ring.h"
#include "hal/dataset/dataset.h"
#include "hal/stereo_camera.h"

namespace wirepose::hal {

struct ReplayConfig {
  std::filesystem::path root;   // data set, layout of hal/dataset/dataset.h
  std::string split = "test";   // folder of scenes under `root`
  std::optional<int> scene_id;  // only this scene; none: all scenes in order
  bool loop = false;            // begin again after the last frame instead of ending the stream
  // Pace in frames per second, at most 1000. 0: a frame as soon as it is asked for, stamped as if
  // at 30 per second.
  double frame_rate_hz = 0;
  // Decode all images in Open and keep them: AcquireFrame then neither reads files nor allocates.
  // At most 1 GiB.
  bool preload = false;
};

// Gives the frames of a data set in order, none dropped: a slow caller gets them late. Capture
// times are sequence / frame rate, so the same data set gives the same frames, stamps and bytes
// each time. Start begins at the first frame. A frame whose files are missing, undecodable or of
// the wrong size arrives with that status; detail() says why. A damaged frame's pixels are zero.
//
// Four buffers, allocated by Open. Without `preload`, decoding a PNG file allocates temporary
// memory. Open: kNotFound (no such folder), kBadData (malformed calibration or scene files),
// kUnsupported (frame rate, too much to preload). AcquireFrame: kTimeout (paced and not due yet), kNoBuffer,
// kEndOfStream.
class ReplayCamera final : public StereoCamera {
 public:
  static constexpr std::uint32_t kBuffers = 4;

  explicit ReplayCamera(ReplayConfig config) : config_(std::move(config)) {}

  // Which frame of the data set a sequence number was; valid while open.
  [[nodiscard]] const dataset::FrameEntry& Entry(std::uint64_t sequence) const;
  // Frames of one pass; 0 when not open.
  [[nodiscard]] std::size_t frame_count() const { return dataset_.frames.size(); }

 private:
  CameraError DoOpen(StereoCalibration& calibration) override;
  CameraError DoStart() override;
  Result<Captured, CameraError> DoAcquire(std::chrono::nanoseconds timeout) override;
  void DoRelease(std::uint32_t buffer) override { ring_.Return(buffer); }
  CameraError DoStop() override { return CameraError::kOk; }
  void DoClose() override;
  [[nodiscard]] std::string_view DoDetail() const override { return detail_; }
  [[nodiscard]] std::string_view DoName() const override { return "replay"; }

  CameraError Fail(CameraError error, std::string detail);
  [[nodiscard]] std::chrono::nanoseconds TimeOf(std::uint64_t sequence) const;
  [[nodiscard]] bool WaitUntilDue(std::chrono::nanoseconds timeout) const;
  // An image file's pixels, or why there are none.
  struct Picture {
    FrameStatus status = FrameStatus::kGood;
    std::vector<std::uint8_t> pixels;  // empty unless kGood
    std::string detail;
  };
  [[nodiscard]] Picture Decode(const std::filesystem::path& path) const;
  [[nodiscard]] CameraError Preload();
  // Fills the buffer of one eye (0 left, 1 right).
  FrameStatus Load(std::size_t eye, const MutableImageView& image);

  ReplayConfig config_;
  dataset::Dataset dataset_;
  BufferRing<kBuffers> ring_;
  std::vector<Picture> preloaded_;  // left, right of each frame in turn; empty without `preload`
  std::string detail_;
  std::uint64_t next_sequence_ = 0;
  std::chrono::steady_clock::time_point started_;
};

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_REPLAY_REPLAY_CAMERA_H_
