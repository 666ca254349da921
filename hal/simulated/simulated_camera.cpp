#include "hal/simulated/simulated_camera.h"

#include <cmath>
#include <condition_variable>
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
#include "sim/scenario_file.h"
#include "sim/scenario_video.h"

namespace wirepose::hal {
namespace {

constexpr std::size_t kTruthsKept = 64;

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
  Worker(const SimulatedConfig& config, const sim::ScenarioSpec& spec, sim::ScenarioVideo video)
      : config_(config), rate_hz_(spec.rate_hz), video_(std::move(video)) {
    ring_.Allocate(video_.calibration().width, video_.calibration().height);
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
    for (const Captured& captured : ready_) ring_.Return(captured.buffer);
    ready_.clear();
    truth_file_.close();
  }

  void Free() { ring_.Free(); }

  Result<Captured, CameraError> Acquire(std::chrono::nanoseconds timeout) {
    std::unique_lock lock(mutex_);
    const auto can_answer = [&] { return !ready_.empty() || is_over_ || has_failed_ || leased_ == kBuffers; };
    if (!changed_.wait_for(lock, timeout, can_answer)) return unexpected(CameraError::kTimeout);
    if (!ready_.empty()) {
      const Captured captured = ready_.front();
      ready_.pop_front();
      ++leased_;
      return captured;
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

  [[nodiscard]] std::optional<SimulatedTruth> Truth(std::uint64_t sequence) const {
    const std::lock_guard lock(mutex_);
    for (const SimulatedTruth& truth : truths_) {
      if (truth.sequence == sequence) return truth;
    }
    return std::nullopt;
  }

 private:
  void Run() {
    for (std::uint64_t i = 0; config_.frame_count == 0 || i < config_.frame_count; ++i) {
      const std::optional<std::uint32_t> buffer = WaitForBuffer();
      if (!buffer) return;
      if (!RenderInto(*buffer, i)) {
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

  // False when the truth file could not be written.
  bool RenderInto(std::uint32_t buffer, std::uint64_t sequence) {
    const sim::StereoShot shot = video_.Shoot(sequence);
    CopyImage(shot.left, ring_.left(buffer));
    CopyImage(shot.right, ring_.right(buffer));
    Captured captured;
    captured.buffer = buffer;
    captured.frame.sequence = sequence;
    captured.frame.capture_time = CaptureTime(
        std::chrono::nanoseconds(std::llround(static_cast<double>(sequence) * 1e9 / rate_hz_)));
    captured.frame.left = ring_.left(buffer);
    captured.frame.right = ring_.right(buffer);

    SimulatedTruth truth{sequence, captured.frame.capture_time, {}};
    for (const sim::ObjectTruth& object : shot.truth.objects) {
      truth.objects.push_back({object.obj_id, object.name, object.T_camera_object, object.visib_fract});
    }
    bool is_written = true;
    if (truth_file_.is_open()) is_written = bool{(truth_file_ << ToJsonLine(truth)).flush()};
    const std::lock_guard lock(mutex_);
    has_failed_ = !is_written;
    if (is_written) {
      truths_.push_back(std::move(truth));
      if (truths_.size() > kTruthsKept) truths_.pop_front();
      ready_.push_back(captured);
    }
    changed_.notify_all();
    return is_written;
  }

  const SimulatedConfig config_;
  const double rate_hz_;
  const sim::ScenarioVideo video_;
  std::ofstream truth_file_;  // the worker thread's while it runs
  std::thread thread_;

  mutable std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  BufferRing<kBuffers> ring_;
  std::deque<Captured> ready_;  // rendered, not yet asked for
  std::deque<SimulatedTruth> truths_;
  std::uint32_t leased_ = 0;
  bool is_stopping_ = false;
  bool is_over_ = false;     // the last frame is rendered
  bool has_failed_ = false;  // the truth file refused a line
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
  worker_ = std::make_unique<Worker>(config_, *spec, *std::move(video));
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
  if (captured) return captured;
  switch (captured.error()) {
    case CameraError::kBadData:
      detail_ = config_.truth_path.string() + ": truth cannot be written; is the disk full?";
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
