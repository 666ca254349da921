#include "hal/libcamera/libcamera_camera.h"

#include <algorithm>

#include "hal/dataset/calibration_file.h"

namespace wirepose::hal {
namespace {

// Between two looks for a camera that is gone: each starts libcamera anew, which takes tens of milliseconds.
constexpr std::chrono::milliseconds kSearchPause{500};

// Half the frame period; 30 Hz when the rate is the camera's own choice.
std::chrono::nanoseconds PairingDistance(const LibcameraConfig& config) {
  const double rate = config.stream.frame_rate_hz > 0 ? config.stream.frame_rate_hz : 30;
  return std::chrono::nanoseconds(static_cast<std::int64_t>(0.5e9 / rate));
}

bool Matches(const libcamera::Camera& camera, const std::string& name) {
  if (camera.id().find(name) != std::string::npos) return true;
  const auto model = camera.properties().get(libcamera::properties::Model);
  return model && std::string(*model).find(name) != std::string::npos;
}

}  // namespace

LibcameraCamera::LibcameraCamera(LibcameraConfig config)
    : config_(std::move(config)), pairing_(PairingDistance(config_)) {}

LibcameraCamera::~LibcameraCamera() { DoClose(); }

CameraError LibcameraCamera::Fail(CameraError error, std::string detail) {
  detail_ = std::move(detail);
  return error;
}

CameraError LibcameraCamera::DoOpen(StereoCalibration& calibration) {
  const auto rig = dataset::ReadCalibration(config_.calibration_path);
  if (!rig) return Fail(CameraError::kBadData, rig.error());
  rig_ = calibration = *rig;
  for (Lease& lease : leases_) {
    for (auto& copy : lease.copy)
      copy.resize(static_cast<std::size_t>(rig_.width) * static_cast<std::size_t>(rig_.height));
  }
  return OpenAll();
}

CameraError LibcameraCamera::OpenAll() {
  manager_ = std::make_unique<libcamera::CameraManager>();
  if (manager_->start() != 0) {
    manager_.reset();
    return Fail(CameraError::kNotFound,
                "libcamera: does not start; is another program of this machine using all cameras?");
  }
  const CameraError error = OpenStreams();
  if (error != CameraError::kOk) CloseAll();
  return error;
}

void LibcameraCamera::CloseAll() {
  streams_.clear();
  if (manager_) manager_->stop();
  manager_.reset();
}

std::shared_ptr<libcamera::Camera> LibcameraCamera::Find(const std::string& name, std::string& error) const {
  std::shared_ptr<libcamera::Camera> found;
  std::string list;
  for (const auto& camera : manager_->cameras()) {
    list.append(list.empty() ? "" : ", ").append(camera->id());
    if (!Matches(*camera, name)) continue;
    if (found) {
      error = "libcamera: '" + name + "' names more than one camera: " + list + "; write more of the id";
      return nullptr;
    }
    found = camera;
  }
  if (!found) {
    error =
        "libcamera: no camera is called '" + name + "'; there is " + (list.empty() ? "none" : list) +
        "; check the cable, the permissions of /dev/video* and /dev/media*, and camera.libcamera in the configuration";
  }
  return found;
}

CameraError LibcameraCamera::OpenStreams() {
  StreamSettings settings = config_.stream;
  settings.width = config_.side_by_side ? 2 * rig_.width : rig_.width;
  settings.height = rig_.height;
  const std::string* const names[] = {&config_.left, &config_.right};
  const std::size_t count = config_.side_by_side ? 1 : 2;
  for (std::size_t eye = 0; eye < count; ++eye) {
    std::string error;
    std::shared_ptr<libcamera::Camera> camera = Find(*names[eye], error);
    if (!camera) return Fail(CameraError::kNotFound, std::move(error));
    auto stream = std::make_unique<CameraStream>(eye, static_cast<StreamListener&>(*this));
    error = stream->Open(std::move(camera), settings);
    if (!error.empty()) return Fail(CameraError::kUnsupported, std::move(error));
    streams_.push_back(std::move(stream));
  }
  return CameraError::kOk;
}

CameraError LibcameraCamera::DoStart() {
  next_sequence_ = 0;
  return StartStreams();
}

CameraError LibcameraCamera::StartStreams() {
  sequence_base_ = next_sequence_;
  {
    const std::lock_guard lock(mutex_);
    pairing_.Clear();
    gone_ = streams_.empty();  // stopped while a camera was gone: AcquireFrame goes on looking for it
  }
  for (const auto& stream : streams_) {
    std::string error = stream->Start();
    if (error.empty()) continue;
    (void)DoStop();
    return Fail(CameraError::kUnsupported, std::move(error));
  }
  detail_.clear();
  return CameraError::kOk;
}

void LibcameraCamera::FrameFinished(std::size_t eye, const EyeFrame& frame) {
  {
    const std::lock_guard lock(mutex_);
    pairing_.Add(eye, frame);
    if (config_.side_by_side) pairing_.Add(1, frame);  // both halves are in one buffer
  }
  changed_.notify_one();
}

void LibcameraCamera::CameraGone() {
  {
    const std::lock_guard lock(mutex_);
    gone_ = true;
  }
  changed_.notify_one();
}

bool LibcameraCamera::AnyLease() {
  const std::lock_guard lock(mutex_);
  return std::any_of(leases_.begin(), leases_.end(), [](const Lease& lease) { return lease.taken; });
}

// After a loss: closes all, and opens all anew as soon as all cameras are there. libcamera itself is started anew too:
// 0.0.3 keeps what it knew of a device by its number, and dies when a camera comes back under the same number.
bool LibcameraCamera::Reconnect() {
  if (AnyLease()) return false;
  for (const auto& stream : streams_) stream->Stop();
  CloseAll();
  const auto now = std::chrono::steady_clock::now();
  if (now < next_search_) return false;
  const bool open = OpenAll() == CameraError::kOk;
  next_search_ = std::chrono::steady_clock::now() + kSearchPause;
  return open && StartStreams() == CameraError::kOk;
}

std::optional<FramePair> LibcameraCamera::WaitForPair(std::chrono::nanoseconds timeout) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    FreedSlots freed;
    std::optional<FramePair> pair;
    bool late = false;
    {
      std::unique_lock lock(mutex_);
      pair = pairing_.TakeNewest(freed);
      if (!pair && freed.empty() && !gone_) {
        late = changed_.wait_until(lock, end) == std::cv_status::timeout;
        if (!late) continue;
        pair = pairing_.TakeNewest(freed);
      }
      late = late || std::chrono::steady_clock::now() >= end || gone_;
    }
    for (const FreedSlot& slot : freed) Requeue(slot.eye, slot.slot);
    if (pair || late) return pair;
  }
}

Result<StereoCamera::Captured, CameraError> LibcameraCamera::DoAcquire(std::chrono::nanoseconds timeout) {
  bool gone = false;
  {
    const std::lock_guard lock(mutex_);
    gone = gone_;
  }
  if (gone && !Reconnect()) {
    if (detail_.empty()) detail_ = "libcamera: a camera was unplugged; plug it in again";
    return unexpected(CameraError::kDisconnected);
  }
  detail_.clear();
  const std::optional<std::uint32_t> buffer = FreeLease();
  if (!buffer) return unexpected(Fail(CameraError::kNoBuffer, "libcamera: all 3 leases are out"));
  const std::optional<FramePair> pair = WaitForPair(timeout);
  Lease& lease = leases_[*buffer];
  const std::lock_guard lock(mutex_);
  if (!pair) {
    lease.taken = false;
    if (gone_)
      return unexpected(Fail(CameraError::kDisconnected, "libcamera: a camera was unplugged; plug it in again"));
    return unexpected(CameraError::kTimeout);
  }
  lease.pair = *pair;
  Captured captured;
  captured.buffer = *buffer;
  Describe(*pair, captured.frame);
  FillImages(lease, captured.frame);
  return captured;
}

std::optional<std::uint32_t> LibcameraCamera::FreeLease() {
  const std::lock_guard lock(mutex_);
  for (std::uint32_t i = 0; i < kMaxLeases; ++i) {
    if (leases_[i].taken) continue;
    leases_[i].taken = true;
    return i;
  }
  return std::nullopt;
}

void LibcameraCamera::Describe(const FramePair& pair, StereoFrame& frame) {
  frame.sequence = std::max(next_sequence_, sequence_base_ + pair.left.sequence);
  next_sequence_ = frame.sequence + 1;
  frame.capture_time = CaptureTime(pair.left.time);
  frame.right_minus_left = pair.right.time - pair.left.time;
  if (std::chrono::abs(frame.right_minus_left) > config_.max_skew) {
    frame.status = FrameStatus::kNotSynchronous;
    detail_ = "libcamera: left and right were exposed " + std::to_string(frame.right_minus_left.count() / 1000) +
              " us apart; trigger the cameras together or allow it in camera.libcamera.max_skew_us";
  }
  if (pair.left.damaged || pair.right.damaged) {
    frame.status = FrameStatus::kImageDamaged;
    detail_ = "libcamera: the camera reports a faulty frame; check cable and power";
  }
}

void LibcameraCamera::FillImages(Lease& lease, StereoFrame& frame) {
  frame.left = Image(0, lease);
  frame.right = Image(1, lease);
  if (frame.left.data != nullptr && frame.right.data != nullptr) return;
  frame.status = FrameStatus::kImageDamaged;
  frame.left = {lease.copy[0].data(), rig_.width, rig_.height, rig_.width};
  frame.right = {lease.copy[1].data(), rig_.width, rig_.height, rig_.width};
  detail_ = "libcamera: a frame was cut short on its way; check cable and USB bandwidth";
}

// Null data when the camera wrote less than an image.
ImageView LibcameraCamera::Image(std::size_t eye, Lease& lease) {
  const EyeFrame& captured = eye == 0 ? lease.pair.left : lease.pair.right;
  const CameraStream& stream = *streams_[config_.side_by_side ? 0 : eye];
  const int x = config_.side_by_side && eye == 1 ? rig_.width : 0;
  return EyeImage(stream.Luma(captured.slot), x, {lease.copy[eye].data(), rig_.width, rig_.height, rig_.width});
}

void LibcameraCamera::Requeue(std::size_t eye, std::uint32_t slot) {
  if (config_.side_by_side && eye == 1) return;  // the same buffer as eye 0
  // A camera that is gone takes nothing; AcquireFrame says so.
  (void)streams_[eye]->Requeue(slot);
}

void LibcameraCamera::DoRelease(std::uint32_t buffer) {
  Lease& lease = leases_[buffer];
  Requeue(0, lease.pair.left.slot);
  Requeue(1, lease.pair.right.slot);
  const std::lock_guard lock(mutex_);
  lease.taken = false;
}

CameraError LibcameraCamera::DoStop() {
  for (const auto& stream : streams_) stream->Stop();
  const std::lock_guard lock(mutex_);
  pairing_.Clear();
  return CameraError::kOk;
}

void LibcameraCamera::DoClose() { CloseAll(); }

}  // namespace wirepose::hal
