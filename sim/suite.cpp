#include "sim/suite.h"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "hal/dataset/dataset_writer.h"
#include "sim/contact_sheet.h"
#include "sim/random.h"
#include "sim/scenario_video.h"

namespace wirepose::sim {
namespace {

namespace fs = std::filesystem;

// FNV-1a over bytes.
class ByteHash {
 public:
  void Add(const void* data, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
      hash_ = (hash_ ^ static_cast<const unsigned char*>(data)[i]) * 0x100000001B3ULL;
    }
  }
  void Add(const std::string& text) { Add(text.data(), text.size() + 1); }

  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325ULL;
};

fs::path HashFile(const fs::path& root) { return root / "content_hash.txt"; }

std::string SceneFolder(int scene_id) {
  char text[16];
  std::snprintf(text, sizeof text, "%06d", scene_id);
  return text;
}

bool IsComplete(const fs::path& root, int scene_id) {
  std::error_code error;
  return fs::exists(root / "test" / SceneFolder(scene_id) / "scene_gt_info_cam1.json", error);
}

// Makes an empty data set, or finds one to continue.
Result<void, std::string> Prepare(const RenderJob& job, const std::vector<TargetMesh>& targets) {
  const std::string hash = ContentHash(job.spec, targets);
  std::error_code error;
  if (fs::exists(job.root, error) && !fs::is_empty(job.root, error)) {
    std::string found;
    if (!(std::ifstream(HashFile(job.root)) >> found)) {
      return unexpected(job.root.string() + ": is not empty and no rendered data set; choose another folder");
    }
    if (found == hash) return {};
    fs::remove_all(job.root, error);
    if (error) return unexpected(job.root.string() + ": cannot be removed: " + error.message());
  }
  const auto writer = dataset::DatasetWriter::Create(job.root, job.spec.camera.calibration);
  if (!writer) return unexpected(writer.error());
  if (const auto written = WriteTargetMeshes(job.root, targets); !written) return unexpected(written.error());
  std::ofstream out(HashFile(job.root));
  if (!(out << hash << "\n") || !out.flush()) {
    return unexpected(HashFile(job.root).string() + ": cannot be written; check permissions and free space");
  }
  return {};
}

// One scene in the making. Its frames may be rendered on different threads.
struct SceneTask {
  const RenderJob* job = nullptr;
  int scene = 0;  // from 0
  int to_do = 0;  // frames, guarded by `mutex`
  std::mutex mutex;
  std::optional<ScenarioVideo> video;
  std::optional<dataset::DatasetWriter> writer;
};

class Renderers {
 public:
  Renderers(const std::vector<RenderJob>& jobs, const std::vector<TargetMesh>& targets,
            const ProgressListener& listener)
      : targets_(targets), listener_(listener), start_(std::chrono::steady_clock::now()) {
    for (const RenderJob& job : jobs) {
      progress_.total += job.spec.scenes * job.spec.frames;
      for (int scene = 0; scene < job.spec.scenes; ++scene) {
        if (IsComplete(job.root, scene + 1)) {
          progress_.reused += job.spec.frames;
          continue;
        }
        tasks_.push_back(std::make_unique<SceneTask>());
        tasks_.back()->job = &job;
        tasks_.back()->scene = scene;
        tasks_.back()->to_do = job.spec.frames;
        for (int frame = 0; frame < job.spec.frames; ++frame) units_.push_back({tasks_.back().get(), frame});
      }
    }
    progress_.done = progress_.reused;
  }

  Result<void, std::string> Run(int threads) {
    std::vector<std::thread> others;
    for (int i = 1; i < threads; ++i) others.emplace_back([this] { Work(); });
    Work();
    for (std::thread& thread : others) thread.join();
    if (!error_.empty()) return unexpected(error_);
    return {};
  }

 private:
  struct Unit {
    SceneTask* task;
    int frame;
  };

  void Work() {
    for (std::size_t i = next_++; i < units_.size() && !has_failed_; i = next_++) {
      const Result<void, std::string> done = Render(units_[i]);
      const std::lock_guard lock(mutex_);
      if (!done) {
        if (error_.empty()) error_ = done.error();
        has_failed_ = true;
        return;
      }
      Report(units_[i].task->job->spec.name);
    }
  }

  Result<void, std::string> Render(const Unit& unit) {
    SceneTask& task = *unit.task;
    if (const auto opened = Open(task); !opened) return opened;
    const auto sequence = static_cast<std::uint64_t>(unit.frame);
    const StereoShot shot = task.video->Shoot(sequence);
    const dataset::DepthImage depth = ToDepthImage(shot.truth);
    const std::lock_guard lock(task.mutex);
    const auto added =
        task.writer->AddFrame(task.scene + 1, ToRecord(unit.frame, task.video->RigAt(sequence), shot.truth),
                              shot.left.view(), shot.right.view(), depth.view());
    if (!added) return added;
    if (--task.to_do > 0) return {};
    const auto finished = task.writer->FinishScene(task.scene + 1);
    task.video.reset();
    return finished;
  }

  Result<void, std::string> Open(SceneTask& task) {
    const std::lock_guard lock(task.mutex);
    if (task.video) return {};
    task.writer.emplace(dataset::DatasetWriter::Continue(task.job->root, task.job->spec.camera.calibration));
    auto video = ScenarioVideo::Create(task.job->spec, task.scene, targets_, 1);
    if (!video) return unexpected(video.error());
    task.video.emplace(*std::move(video));
    return {};
  }

  // The caller holds `mutex_`.
  void Report(const std::string& name) {
    ++progress_.done;
    progress_.name = name;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    progress_.elapsed_s = elapsed.count();
    progress_.left_s = elapsed.count() / (progress_.done - progress_.reused) * (progress_.total - progress_.done);
    if (listener_) listener_(progress_);
  }

  const std::vector<TargetMesh>& targets_;
  const ProgressListener& listener_;
  const std::chrono::steady_clock::time_point start_;
  std::vector<std::unique_ptr<SceneTask>> tasks_;
  std::vector<Unit> units_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> has_failed_{false};
  std::mutex mutex_;  // guards the two below
  RenderProgress progress_;
  std::string error_;
};

}  // namespace

std::string ContentHash(const ScenarioSpec& spec, const std::vector<TargetMesh>& targets) {
  ByteHash hash;
  hash.Add(WIREPOSE_SIM_SOURCE_HASH);
  hash.Add(spec.source);
  for (const double number :
       {double(spec.seed), double(spec.scenes), double(spec.frames), spec.rate_hz, double(spec.samples)}) {
    hash.Add(&number, sizeof number);
  }
  const StereoCalibration& c = spec.camera.calibration;
  for (const CameraIntrinsics& eye : {c.left, c.right}) hash.Add(&eye, sizeof eye);
  hash.Add(c.T_right_left.R.data(), 9 * sizeof(double));
  hash.Add(c.T_right_left.t.data(), 3 * sizeof(double));
  for (const TargetMesh& target : targets) {
    hash.Add(target.name);
    hash.Add(&target.obj_id, sizeof target.obj_id);
    hash.Add(target.mesh.vertices.data(), target.mesh.vertices.size() * sizeof(Vector3));
    hash.Add(target.mesh.triangles.data(), target.mesh.triangles.size() * sizeof target.mesh.triangles[0]);
  }
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash.value()));
  return text;
}

Result<void, std::string> RenderDatasets(const std::vector<RenderJob>& jobs, const std::vector<TargetMesh>& targets,
                                         int threads, const ProgressListener& listener) {
  for (const RenderJob& job : jobs) {
    if (const auto prepared = Prepare(job, targets); !prepared) return prepared;
  }
  if (const auto rendered = Renderers(jobs, targets, listener).Run(threads); !rendered) return rendered;
  for (const RenderJob& job : jobs) {
    if (const auto written = WriteContactSheet(job.root, job.root / "contact_sheet.png"); !written) return written;
  }
  return {};
}

}  // namespace wirepose::sim
