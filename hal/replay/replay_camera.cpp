#include "hal/replay/replay_camera.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

namespace wirepose::hal {
namespace {

constexpr double kNominalRate = 30;  // Hz, of stamps when frames come as fast as asked for
constexpr double kMaxRate = 1000;    // Hz

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
  ring_.Allocate(calibration.width, calibration.height);
  detail_.clear();
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

FrameStatus ReplayCamera::Load(const std::filesystem::path& path, const MutableImageView& image) {
  const std::size_t bytes = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const Result<dataset::GrayImage, dataset::ImageError> file = dataset::ReadGrayPng(path);
  if (file && file->width == image.width && file->height == image.height) {
    std::memcpy(image.data, file->pixels.data(), bytes);
    return FrameStatus::kGood;
  }
  std::memset(image.data, 0, bytes);
  if (!file) {
    detail_ = file.error().message;
    return file.error().missing ? FrameStatus::kImageMissing : FrameStatus::kImageDamaged;
  }
  detail_ = path.string() + ": image is " + std::to_string(file->width) + " x " + std::to_string(file->height) +
            ", calib.yaml says " + std::to_string(image.width) + " x " + std::to_string(image.height) +
            "; record it again or calibrate for its size";
  return FrameStatus::kImageDamaged;
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
  const dataset::FrameEntry& entry = Entry(next_sequence_);
  Captured captured;
  captured.buffer = *buffer;
  StereoFrame& frame = captured.frame;
  frame.sequence = next_sequence_;
  frame.capture_time = CaptureTime(TimeOf(next_sequence_));
  const FrameStatus left = Load(entry.left_path, ring_.left(*buffer));
  const FrameStatus right = Load(entry.right_path, ring_.right(*buffer));
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
