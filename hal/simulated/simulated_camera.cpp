#include "hal/simulated/simulated_camera.h"

#include <array>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <deque>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>
#include <utility>

#include "hal/buffer_ring.h"
#include "hal/dataset/calibration_file.h"
#include "hal/simulated/feed_faults.h"
#include "hal/simulated/frame_source.h"
#include "sim/scenario_file.h"
#include "sim/scenario_video.h"
#include "sim/suite.h"

namespace wirepose::hal {
namespace {

constexpr std::size_t kTruthsKept = 64;
constexpr std::size_t kDetailRoom = 160;  // bytes of what the camera says of a frame

void CopyImage(const dataset::GrayImage& from, const MutableImageView& to) {
  std::memcpy(to.data, from.pixels.data(), from.pixels.size());
}

std::string ToJsonLine(const SimulatedTruth& truth) {
  nlohmann::ordered_json line = {{"sequence", truth.sequence},
                                 {"capture_time_ns", truth.capture_time.time_since_epoch().count()},
                                 {"objects", nlohmann::ordered_json::array()}};
  for (const SimulatedObject& object : truth.objects) {
    const Pose& T = object.T_camera_model;
    nlohmann::ordered_json R = nlohmann::ordered_json::array();
    for (int i = 0; i < 9; ++i) R.push_back(T.R(i / 3, i % 3));
    line["objects"].push_back({{"obj_id", object.obj_id},
                               {"name", object.name},
                               {"R", R},
                               {"t", {T.t.x(), T.t.y(), T.t.z()}},
                               {"visib_fract", object.visib_fract}});
  }
  return line.dump() + "\n";
}

// The scenario with what the configuration changes in it.
Result<sim::ScenarioSpec, std::string> SpecOf(const SimulatedConfig& config) {
  sim::ScenarioSpec spec;
  if (!config.scenario_path.empty()) {
    const Result<sim::ScenarioSpec, std::string> read = sim::ReadScenario(config.scenario_path);
    if (!read) return read;
    spec = *read;
  }
  if (!config.calibration_path.empty()) {
    const Result<StereoCalibration, std::string> rig = dataset::ReadCalibration(config.calibration_path);
    if (!rig) return unexpected(rig.error());
    spec.camera.calibration = *rig;
  }
  spec.seed = config.seed.value_or(spec.seed);
  spec.rate_hz = config.frame_rate_hz.value_or(spec.rate_hz);
  spec.samples = config.samples_per_pixel.value_or(spec.samples);
  return spec;
}

}  // namespace

// Renders ahead. Lives from Open to Close; its thread from Start to Stop.
class SimulatedCamera::Worker {
 public:
  Worker(const SimulatedConfig& config, const sim::ScenarioSpec& spec, FrameSource source)
      : config_(config), spec_(spec), source_(std::move(source)) {
    ring_.Allocate(source_.calibration().width, source_.calibration().height);
    ready_.reserve(kBuffers + 1);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker() { Stop(); }

  [[nodiscard]] bool Start() {
    {
      const std::lock_guard lock(mutex_);
      truths_.clear();
      is_stopping_ = is_over_ = has_failed_ = false;
    }
    source_.Restart();
    if (!config_.truth_path.empty()) {
      truth_file_ = std::ofstream(config_.truth_path, std::ios::binary | std::ios::trunc);
      if (!truth_file_) return false;
    }
    thread_ = std::thread([this] { Run(); });
    return true;
  }

  // Waits for the frame in the making, up to a second or two.
  void Stop() {
    {
      const std::lock_guard lock(mutex_);
      is_stopping_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
    const std::lock_guard lock(mutex_);
    for (const Event& event : ready_) {
      if (event.captured) ring_.Return(event.captured->buffer);
    }
    ready_.clear();
    truth_file_.close();
  }

  void Free() { ring_.Free(); }

  Result<Captured, CameraError> Acquire(std::chrono::nanoseconds timeout) {
    std::unique_lock lock(mutex_);
    const auto can_answer = [&] { return !ready_.empty() || is_over_ || has_failed_ || leased_ == kBuffers; };
    if (!changed_.wait_for(lock, timeout, can_answer)) return unexpected(CameraError::kTimeout);
    if (!ready_.empty()) {
      const Event event = ready_.front();
      ready_.erase(ready_.begin());
      if (!event.captured) {
        changed_.notify_all();  // there is room for another event
        return unexpected(CameraError::kDisconnected);
      }
      ++leased_;
      return *event.captured;
    }
    if (has_failed_) return unexpected(CameraError::kBadData);
    return unexpected(is_over_ ? CameraError::kEndOfStream : CameraError::kNoBuffer);
  }

  void Release(std::uint32_t buffer) {
    {
      const std::lock_guard lock(mutex_);
      ring_.Return(buffer);
      --leased_;
    }
    changed_.notify_all();
  }

  // Why it has failed; after Acquire gave kBadData.
  [[nodiscard]] std::string reason() const {
    const std::lock_guard lock(mutex_);
    return reason_;
  }

  [[nodiscard]] std::optional<SimulatedTruth> Truth(std::uint64_t sequence) const {
    const std::lock_guard lock(mutex_);
    for (const SimulatedTruth& truth : truths_) {
      if (truth.sequence == sequence) return truth;
    }
    return std::nullopt;
  }

 private:
  void Run() {
    start_ = std::chrono::steady_clock::now();
    for (std::uint64_t i = 0; config_.frame_count == 0 || i < config_.frame_count; ++i) {
      const FramePlan plan = PlanFrame(spec_.feed, i, spec_.seed);
      if (plan.is_dropped) continue;
      if (plan.is_disconnected) {
        if (!ReportDisconnected()) return;
        continue;
      }
      const std::optional<std::uint32_t> buffer = WaitForBuffer();
      if (!buffer) return;
      if (!FillBuffer(*buffer, i, plan)) {
        ring_.Return(*buffer);
        return;
      }
    }
    const std::lock_guard lock(mutex_);
    is_over_ = true;
    changed_.notify_all();
  }

  // Nothing when the stream is to stop.
  std::optional<std::uint32_t> WaitForBuffer() {
    std::unique_lock lock(mutex_);
    std::optional<std::uint32_t> buffer;
    changed_.wait(lock, [&] {
      if (is_stopping_) return true;
      buffer = ring_.Take();
      return buffer.has_value();
    });
    return buffer;
  }

  // One AcquireFrame will say so. Waits until there is somebody to hear it: false when the stream is
  // to stop.
  bool ReportDisconnected() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return is_stopping_ || ready_.size() < kBuffers; });
    if (is_stopping_) return false;
    ready_.push_back({std::nullopt});
    changed_.notify_all();
    return true;
  }

  // False when a file could not be written.
  bool FillBuffer(std::uint32_t buffer, std::uint64_t sequence, const FramePlan& plan) {
    const Result<const CachedFrame*, std::string> made = source_.Make(sequence, plan);
    if (!made) return Fail(made.error());
    const CachedFrame& frame = **made;
    CopyImage(frame.images.left, ring_.left(buffer));
    CopyImage(frame.images.right, ring_.right(buffer));
    const std::chrono::nanoseconds since_start(std::llround(static_cast<double>(sequence) * 1e9 / spec_.rate_hz));
    Captured captured;
    captured.buffer = buffer;
    captured.frame.sequence = sequence;
    captured.frame.capture_time = CaptureTime(since_start + plan.stamp_shift);
    captured.frame.right_minus_left = std::chrono::nanoseconds(std::llround(1e9 * plan.told_lag_s));
    captured.frame.left = ring_.left(buffer);
    captured.frame.right = ring_.right(buffer);
    if (std::abs(plan.told_lag_s) >= kMaxLagS) captured.frame.status = FrameStatus::kNotSynchronous;

    const SimulatedTruth truth{sequence, captured.frame.capture_time, frame.objects};
    if (truth_file_.is_open() && !(truth_file_ << ToJsonLine(truth)).flush()) {
      return Fail(config_.truth_path.string() + ": truth cannot be written; is the disk full?");
    }
    return Publish(captured, truth, start_ + since_start);
  }

  // With a cache or a loop, not before `due`: as a camera would.
  bool Publish(const Captured& captured, const SimulatedTruth& truth, std::chrono::steady_clock::time_point due) {
    std::unique_lock lock(mutex_);
    if (source_.keeps_frames()) changed_.wait_until(lock, due, [&] { return is_stopping_; });
    truths_.push_back(truth);
    if (truths_.size() > kTruthsKept) truths_.pop_front();
    ready_.push_back({captured});
    changed_.notify_all();
    return true;
  }

  bool Fail(const std::string& reason) {
    const std::lock_guard lock(mutex_);
    has_failed_ = true;
    reason_ = reason;
    changed_.notify_all();
    return false;
  }

  // What waits for AcquireFrame: a frame, or word that the device is gone.
  struct Event {
    std::optional<Captured> captured;
  };

  // An offset that a robot's motion makes visible: a pixel at 1 m, 1 m/s and f 500 px takes 2 ms.
  static constexpr double kMaxLagS = 1e-3;

  const SimulatedConfig config_;
  const sim::ScenarioSpec spec_;

  // The worker thread's while it runs.
  FrameSource source_;
  std::ofstream truth_file_;
  std::chrono::steady_clock::time_point start_;

  std::thread thread_;

  mutable std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  BufferRing<kBuffers> ring_;
  std::vector<Event> ready_;  // not yet asked for, oldest first; a deque would free blocks on the caller's thread
  std::deque<SimulatedTruth> truths_;
  std::uint32_t leased_ = 0;
  bool is_stopping_ = false;
  bool is_over_ = false;     // the last frame is rendered
  bool has_failed_ = false;  // a file could not be written
  std::string reason_;       // why it has failed
};

SimulatedCamera::SimulatedCamera(SimulatedConfig config) : config_(std::move(config)) {}
SimulatedCamera::~SimulatedCamera() = default;

std::optional<SimulatedTruth> SimulatedCamera::Truth(std::uint64_t sequence) const {
  return worker_ ? worker_->Truth(sequence) : std::nullopt;
}

CameraError SimulatedCamera::DoOpen(StereoCalibration& calibration) {
  std::error_code error;
  if (!std::filesystem::is_directory(config_.mesh_dir, error)) {
    detail_ = config_.mesh_dir.string() + ": no such folder of meshes; check the path";
    return CameraError::kNotFound;
  }
  const Result<std::vector<sim::TargetMesh>, std::string> targets = sim::LoadTargetMeshes(config_.mesh_dir);
  if (!targets) {
    detail_ = targets.error();
    return CameraError::kBadData;
  }
  if (config_.loop_frames > kMaxLoopFrames) {
    detail_ = "simulated: a loop of " + std::to_string(config_.loop_frames) + " frames; at most " +
              std::to_string(kMaxLoopFrames) + " are kept in memory: give fewer, or a cache";
    return CameraError::kUnsupported;
  }
  const Result<sim::ScenarioSpec, std::string> spec = SpecOf(config_);
  if (!spec) {
    detail_ = spec.error();
    return CameraError::kBadData;
  }
  Result<sim::ScenarioVideo, std::string> video = sim::ScenarioVideo::Create(*spec, config_.scene, *targets);
  if (!video) {
    detail_ = video.error();
    return CameraError::kUnsupported;
  }
  calibration = video->calibration();
  std::optional<FrameCache> cache;
  if (!config_.cache_path.empty()) {
    cache.emplace(config_.cache_path / (sim::ContentHash(*spec, *targets) + "_" + std::to_string(config_.scene)));
  }
  worker_ = std::make_unique<Worker>(config_, *spec,
                                     FrameSource(*spec, *std::move(video), std::move(cache), config_.loop_frames));
  detail_.reserve(kDetailRoom);  // what a running camera says needs no heap
  detail_.clear();
  return CameraError::kOk;
}

CameraError SimulatedCamera::DoStart() {
  detail_.clear();
  if (worker_->Start()) return CameraError::kOk;
  detail_ = config_.truth_path.string() + ": truth cannot be written; check folder and permissions";
  return CameraError::kBadData;
}

Result<StereoCamera::Captured, CameraError> SimulatedCamera::DoAcquire(std::chrono::nanoseconds timeout) {
  detail_.clear();
  Result<Captured, CameraError> captured = worker_->Acquire(timeout);
  if (captured) {
    if (captured->frame.status == FrameStatus::kNotSynchronous) {
      std::array<char, kDetailRoom> text;
      std::snprintf(text.data(), text.size(), "simulated: the right eye was exposed %lld us after the left one",
                    static_cast<long long>(captured->frame.right_minus_left.count() / 1000));
      detail_ = text.data();
    }
    return captured;
  }
  switch (captured.error()) {
    case CameraError::kBadData:
      detail_ = worker_->reason();
      break;
    case CameraError::kDisconnected:
      detail_ = "simulated: the camera is disconnected, as the scenario says; it comes back";
      break;
    case CameraError::kTimeout:
      detail_ = "simulated: the next frame is still being rendered";
      break;
    case CameraError::kNoBuffer:
      detail_ = "simulated: all 4 buffers are leased";
      break;
    default:
      detail_ = "simulated: the last frame is over";
      break;
  }
  return captured;
}

void SimulatedCamera::DoRelease(std::uint32_t buffer) { worker_->Release(buffer); }

CameraError SimulatedCamera::DoStop() {
  worker_->Stop();
  detail_.clear();
  return CameraError::kOk;
}

void SimulatedCamera::DoClose() {
  worker_->Stop();
  worker_->Free();
  worker_.reset();
  detail_.clear();
}

}  // namespace wirepose::hal
