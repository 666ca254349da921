// One libcamera camera: its buffers mapped, its requests recycled.
#ifndef WIREPOSE_HAL_LIBCAMERA_CAMERA_STREAM_H_
#define WIREPOSE_HAL_LIBCAMERA_CAMERA_STREAM_H_

#include <libcamera/libcamera.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hal/libcamera/frame_pairing.h"
#include "hal/libcamera/libcamera_config.h"
#include "hal/libcamera/luma.h"

namespace wirepose::hal {

// Hears of finished frames and lost cameras, on libcamera's thread. Must not call the stream.
class StreamListener {
 public:
  virtual void FrameFinished(std::size_t eye, const EyeFrame& frame) = 0;
  virtual void CameraGone() = 0;

 protected:
  ~StreamListener() = default;
};

// One thread at a time calls. Open allocates everything of ours; libcamera allocates some memory of its own a request.
class CameraStream {
 public:
  CameraStream(std::size_t eye, StreamListener& listener) : eye_(eye), listener_(listener) {}
  ~CameraStream() { Close(); }
  CameraStream(const CameraStream&) = delete;
  CameraStream& operator=(const CameraStream&) = delete;

  // Takes the camera, chooses the format, maps the buffers. Empty, or what failed and what to do. `camera` is given up
  // by Close, before its manager stops.
  [[nodiscard]] std::string Open(std::shared_ptr<libcamera::Camera> camera, const StreamSettings& settings);
  [[nodiscard]] std::string Start();
  // Stops the camera; buffers that were with it come back unfilled, without a word to the listener.
  void Stop();
  void Close();

  // Gives a finished frame's buffer back to the camera. False when the camera does not take it.
  bool Requeue(std::uint32_t slot);
  // What the camera wrote into a finished frame's buffer; valid until Requeue.
  [[nodiscard]] LumaSource Luma(std::uint32_t slot) const;

 private:
  struct Slot {
    libcamera::FrameBuffer* buffer = nullptr;
    std::unique_ptr<libcamera::Request> request;
    void* mapping = nullptr;
    std::size_t mapped_bytes = 0;
  };

  [[nodiscard]] std::string ChooseFormat(const StreamSettings& settings);
  [[nodiscard]] std::string MapBuffers();
  [[nodiscard]] std::string Map(Slot& slot) const;
  void SetControls(libcamera::ControlList& controls) const;
  void RequestCompleted(libcamera::Request* request);
  void Disconnected() { listener_.CameraGone(); }
  [[nodiscard]] std::string Error(const std::string& what) const;

  const std::size_t eye_;
  StreamListener& listener_;
  StreamSettings settings_;
  std::shared_ptr<libcamera::Camera> camera_;
  std::unique_ptr<libcamera::CameraConfiguration> configuration_;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
  libcamera::Stream* stream_ = nullptr;
  LumaLayout layout_ = LumaLayout::kPlane;
  std::array<Slot, kCameraBuffers> slots_;
};

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_LIBCAMERA_CAMERA_STREAM_H_
