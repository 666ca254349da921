#include "hal/stereo_camera.h"

namespace wirepose::hal {

FrameLease& FrameLease::operator=(FrameLease&& other) noexcept {
  if (this == &other) return *this;
  Release();
  camera_ = std::exchange(other.camera_, nullptr);
  buffer_ = other.buffer_;
  frame_ = other.frame_;
  return *this;
}

void FrameLease::Release() {
  if (camera_ == nullptr) return;
  std::exchange(camera_, nullptr)->DoRelease(buffer_);
}

CameraError StereoCamera::Open() {
  if (state_ != State::kClosed) return CameraError::kWrongState;
  const CameraError error = DoOpen(calibration_);
  if (error == CameraError::kOk) state_ = State::kOpen;
  return error;
}

CameraError StereoCamera::Start() {
  if (state_ != State::kOpen) return CameraError::kWrongState;
  const CameraError error = DoStart();
  if (error == CameraError::kOk) state_ = State::kStreaming;
  return error;
}

Result<FrameLease, CameraError> StereoCamera::AcquireFrame(std::chrono::nanoseconds timeout) {
  if (state_ != State::kStreaming) return unexpected(CameraError::kWrongState);
  const Result<Captured, CameraError> captured = DoAcquire(timeout);
  if (!captured) return unexpected(captured.error());
  return FrameLease(this, captured->buffer, captured->frame);
}

CameraError StereoCamera::Stop() {
  if (state_ == State::kClosed) return CameraError::kWrongState;
  if (state_ == State::kOpen) return CameraError::kOk;
  state_ = State::kOpen;
  return DoStop();
}

CameraError StereoCamera::Close() {
  if (state_ == State::kStreaming) return CameraError::kWrongState;
  if (state_ == State::kOpen) DoClose();
  state_ = State::kClosed;
  return CameraError::kOk;
}

const char* Describe(CameraError error) {
  switch (error) {
    case CameraError::kOk:
      return "ok";
    case CameraError::kWrongState:
      return "call is not legal in this state";
    case CameraError::kNotFound:
      return "camera not found";
    case CameraError::kBadData:
      return "malformed calibration or data set";
    case CameraError::kUnsupported:
      return "not supported by the camera";
    case CameraError::kTimeout:
      return "no frame in time";
    case CameraError::kNoBuffer:
      return "every buffer is leased";
    case CameraError::kEndOfStream:
      return "end of stream";
    case CameraError::kDisconnected:
      return "camera disconnected";
  }
  return "?";
}

const char* Describe(FrameStatus status) {
  switch (status) {
    case FrameStatus::kGood:
      return "good";
    case FrameStatus::kImageMissing:
      return "image missing";
    case FrameStatus::kImageDamaged:
      return "image damaged";
    case FrameStatus::kNotSynchronous:
      return "left and right not synchronous";
  }
  return "?";
}

}  // namespace wirepose::hal
