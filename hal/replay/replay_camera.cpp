#include "hal/replay/replay_camera.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

namespace wirepose::hal {
namespace {

constexpr double kNominalRate = 30;                        // Hz, of stamps when frames come as fast as asked for
constexpr double kMaxRate = 1000;                          // Hz
constexpr std::size_t kMaxPreload = std::size_t{1} << 30;  // bytes

}  // namespace

CameraError ReplayCamera::Fail(CameraError error, std::string detail) {
  detail_ = std::move(detail);
  return error;
}

CameraError ReplayCamera::DoOpen(StereoCalibration& calibration) {
  const double rate = config_.frame_rate_hz;
  if (!(rate >= 0 && rate <= kMaxRate)) {
    return Fail(CameraError::kUnsupported, "replay: frame rate is not in 0..1000 Hz; 0 means as fast as asked for");
  }
  std::error_code error;
  if (!std::filesystem::is_directory(config_.root, error)) {
    return Fail(CameraError::kNotFound, config_.root.string() + ": no such data set folder; check the path");
  }
  Result<dataset::Dataset, std::string> dataset = dataset::ReadDataset(config_.root, config_.split);
  if (!dataset) return Fail(CameraError::kBadData, std::move(dataset.error()));
  if (config_.scene_id) {
    std::erase_if(dataset->frames,
                  [&](const dataset::FrameEntry& frame) { return frame.scene_id != *config_.scene_id; });
    if (dataset->frames.empty()) {
      return Fail(CameraError::kNotFound, (config_.root / config_.split).string() + ": scene " +
                                              std::to_string(*config_.scene_id) +
                                              " does not exist or is empty; choose another");
    }
  }
  dataset_ = *std::move(dataset);
  calibration = dataset_.calibration;
  detail_.clear();
  preloaded_.clear();
  if (config_.preload) {
    if (const CameraError failed = Preload(); failed != CameraError::kOk) return failed;
  }
  ring_.Allocate(calibration.width, calibration.height);
  return CameraError::kOk;
}

CameraError ReplayCamera::DoStart() {
  next_sequence_ = 0;
  started_ = std::chrono::steady_clock::now();
  detail_.clear();
  return CameraError::kOk;
}

void ReplayCamera::DoClose() {
  ring_.Free();
  dataset_ = {};
  preloaded_ = {};
  detail_.clear();
}

const dataset::FrameEntry& ReplayCamera::Entry(std::uint64_t sequence) const {
  return dataset_.frames[sequence % dataset_.frames.size()];
}

std::chrono::nanoseconds ReplayCamera::TimeOf(std::uint64_t sequence) const {
  const double rate = config_.frame_rate_hz > 0 ? config_.frame_rate_hz : kNominalRate;
  return std::chrono::nanoseconds(std::llround(static_cast<double>(sequence) * 1e9 / rate));
}

bool ReplayCamera::WaitUntilDue(std::chrono::nanoseconds timeout) const {
  if (config_.frame_rate_hz == 0) return true;
  const auto due = started_ + TimeOf(next_sequence_);
  const auto wait = due - std::chrono::steady_clock::now();
  std::this_thread::sleep_for(std::clamp<std::chrono::nanoseconds>(wait, std::chrono::nanoseconds{0},
                                                                   std::max(timeout, std::chrono::nanoseconds{0})));
  return wait <= timeout;
}

ReplayCamera::Picture ReplayCamera::Decode(const std::filesystem::path& path) const {
  Picture picture;
  Result<dataset::GrayImage, dataset::ImageError> file = dataset::ReadGrayPng(path);
  const StereoCalibration& rig = dataset_.calibration;
  if (file && file->width == rig.width && file->height == rig.height) {
    picture.pixels = std::move(file->pixels);
  } else if (!file) {
    picture.status = file.error().missing ? FrameStatus::kImageMissing : FrameStatus::kImageDamaged;
    picture.detail = file.error().message;
  } else {
    picture.status = FrameStatus::kImageDamaged;
    picture.detail = path.string() + ": image is " + std::to_string(file->width) + " x " +
                     std::to_string(file->height) + ", calib.yaml says " + std::to_string(rig.width) + " x " +
                     std::to_string(rig.height) + "; record it again or calibrate for its size";
  }
  return picture;
}

CameraError ReplayCamera::Preload() {
  const StereoCalibration& rig = dataset_.calibration;
  const std::size_t bytes =
      2 * dataset_.frames.size() * static_cast<std::size_t>(rig.width) * static_cast<std::size_t>(rig.height);
  if (bytes > kMaxPreload) {
    return Fail(CameraError::kUnsupported,
                config_.root.string() + ": more than 1 GiB of images; leave out preload or name one scene");
  }
  preloaded_.reserve(2 * dataset_.frames.size());
  for (const dataset::FrameEntry& entry : dataset_.frames) {
    for (const auto& path : {entry.left_path, entry.right_path}) preloaded_.push_back(Decode(path));
  }
  return CameraError::kOk;
}

FrameStatus ReplayCamera::Load(std::size_t eye, const MutableImageView& image) {
  const dataset::FrameEntry& entry = Entry(next_sequence_);
  Picture decoded;
  if (!config_.preload) decoded = Decode(eye == 0 ? entry.left_path : entry.right_path);
  const std::size_t index = 2 * static_cast<std::size_t>(next_sequence_ % dataset_.frames.size()) + eye;
  const Picture& picture = config_.preload ? preloaded_[index] : decoded;
  if (picture.status == FrameStatus::kGood) {
    std::memcpy(image.data, picture.pixels.data(), picture.pixels.size());
  } else {
    std::memset(image.data, 0, static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    detail_ = picture.detail;
  }
  return picture.status;
}

Result<StereoCamera::Captured, CameraError> ReplayCamera::DoAcquire(std::chrono::nanoseconds timeout) {
  detail_.clear();
  if (!config_.loop && next_sequence_ >= dataset_.frames.size()) {
    return unexpected(Fail(CameraError::kEndOfStream, "replay: the data set's last frame is over"));
  }
  if (!WaitUntilDue(timeout)) return unexpected(CameraError::kTimeout);
  const std::optional<std::uint32_t> buffer = ring_.Take();
  if (!buffer) {
    return unexpected(Fail(CameraError::kNoBuffer, "replay: all 4 buffers are leased"));
  }
  Captured captured;
  captured.buffer = *buffer;
  StereoFrame& frame = captured.frame;
  frame.sequence = next_sequence_;
  frame.capture_time = CaptureTime(TimeOf(next_sequence_));
  const FrameStatus left = Load(0, ring_.left(*buffer));
  const FrameStatus right = Load(1, ring_.right(*buffer));
  if (left == FrameStatus::kImageMissing || right == FrameStatus::kImageMissing) {
    frame.status = FrameStatus::kImageMissing;
  } else {
    frame.status = left != FrameStatus::kGood ? left : right;
    frame.left = ring_.left(*buffer);
    frame.right = ring_.right(*buffer);
  }
  ++next_sequence_;
  return captured;
}

}  // namespace wirepose::hal
