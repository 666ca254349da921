#include "tools/cli/compare_command.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "hal/simulated/simulated_camera.h"
#include "pipeline/recognizer.h"
#include "tools/cli/command.h"
#include "tools/cli/recognizer_overlay.h"
#include "tools/evaluation/model_set.h"
#include "tools/evaluation/streams.h"

namespace wirepose::cli {
namespace {

using evaluation::Estimate;
using evaluation::FrameTruth;
using evaluation::GroundTruth;
using evaluation::InstanceOutcome;
using evaluation::Metrics;

struct CompareArguments {
  std::filesystem::path truth, received, models;
  int min_hits = 1;
  std::filesystem::path overlay;  // empty: none
  hal::SimulatedConfig camera;    // as the wireposed had it that was listened to; for the overlay
};

std::string PoseText(const evaluation::RigidMm& T) {
  const Eigen::Quaterniond q(T.R);
  const double sign = q.w() < 0 ? -1 : 1;
  return fmt::format("({:8.1f} {:8.1f} {:8.1f}) mm  q ({:6.3f} {:6.3f} {:6.3f} {:6.3f})", T.t_mm.x(), T.t_mm.y(),
                     T.t_mm.z(), sign * q.x(), sign * q.y(), sign * q.z(), sign * q.w());
}

void PrintOutcome(const InstanceOutcome& o, const evaluation::ModelSet& models) {
  const ModelView* model = models.Find(static_cast<std::uint32_t>(o.object_id));
  fmt::print("frame {:3}  {} (model {}), {:.0f} % visible\n", o.image_id, model != nullptr ? model->name : "?",
             o.object_id, 100 * o.visible_fraction);
  fmt::print("  truth     {}\n", PoseText(o.truth));
  if (o.hit) {
    fmt::print("  received  {}  score {:.2f}\n  error     {:.2f} mm  {:.2f} deg\n", PoseText(o.estimate), o.score,
               o.translation_mm, o.rotation_deg);
  } else if (o.best_mssd_mm) {
    fmt::print("  received  a pose that is off by {:.1f} mm: not counted as found\n", *o.best_mssd_mm);
  } else {
    fmt::print("  received  nothing\n");
  }
}

void PrintTotals(const Metrics& m) {
  const auto median = [](const std::vector<double>& values) {
    const auto p = evaluation::Percentile(values, 0.5);
    return p ? fmt::format("{:.2f}", *p) : std::string("-");
  };
  fmt::print(
      "{} frames received: {} of {} visible objects found, {} false alarms; median error {} mm, {} "
      "deg\n",
      m.frames, m.total.all.hits, m.total.all.instances, m.total.false_positives, median(m.total.translation_errors_mm),
      median(m.total.rotation_errors_deg));
}

// The received frame with the most objects found; the earliest of equals, which is rendered
// soonest.
int BestFrame(const Metrics& m) {
  std::map<int, int> hits;
  for (const InstanceOutcome& o : m.instances) hits[o.image_id] += o.hit;
  const auto best = std::ranges::max_element(hits, {}, [](const auto& entry) { return entry.second; });
  return best != hits.end() ? best->first : 0;
}

[[noreturn]] void FailOnCamera(const hal::StereoCamera& camera, hal::CameraError error) {
  throw WorkFailed(fmt::format("simulated camera: {} {}", hal::Describe(error), camera.detail()));
}

// The camera's frame `sequence`; all before it are rendered, too.
hal::FrameLease RenderFrame(hal::SimulatedCamera& camera, std::uint64_t sequence) {
  for (const hal::CameraError error : {camera.Open(), camera.Start()}) {
    if (error != hal::CameraError::kOk) FailOnCamera(camera, error);
  }
  while (true) {
    auto lease = camera.AcquireFrame(std::chrono::seconds(60));
    if (!lease) FailOnCamera(camera, lease.error());
    if (lease->frame().sequence >= sequence) return std::move(*lease);
  }
}

// The poses drawn are those received; a frame rendered from another scene would make them look
// wrong, or right.
void CheckSameScene(const hal::SimulatedCamera& camera, const FrameTruth& frame) {
  const auto truth = camera.Truth(static_cast<std::uint64_t>(frame.image_id));
  for (const evaluation::InstanceTruth& i : frame.instances) {
    const bool same =
        truth && std::ranges::any_of(truth->objects, [&](const hal::SimulatedObject& o) {
          return o.obj_id == i.object_id && (1000 * o.T_camera_model.t - i.T_camera_model.t_mm).norm() < 1e-3;
        });
    if (!same) throw UsageError("--overlay: the camera's options differ from those the truth was written with");
  }
}

Pose ToMetres(const evaluation::RigidMm& T) { return {T.R, T.t_mm / 1000}; }

void DrawReceived(const CompareArguments& arguments, const evaluation::ModelSet& models, const FrameTruth& frame,
                  const std::vector<Estimate>& estimates) {
  hal::SimulatedConfig config = arguments.camera;
  config.frame_count = static_cast<std::uint64_t>(frame.image_id) + 1;
  hal::SimulatedCamera camera(config);
  const hal::FrameLease lease = RenderFrame(camera, static_cast<std::uint64_t>(frame.image_id));
  CheckSameScene(camera, frame);
  static Recognizer recognizer;
  static RecognitionResult result;
  bool ok = recognizer.Configure(camera.calibration()) == RecognizerError::kOk;
  for (const ModelView& m : models.views) ok = ok && recognizer.AddModel(m) == RecognizerError::kOk;
  ok = ok && recognizer.Process(lease->left, lease->right, nullptr, result) == RecognizerError::kOk;
  if (!ok) throw WorkFailed("--overlay: the recognizer refused the simulated frame; check --models");
  overlay::OverlayInput input = LinesOf(recognizer);
  for (const evaluation::InstanceTruth& i : frame.instances) {
    const ModelView* model = models.Find(static_cast<std::uint32_t>(i.object_id));
    AddObject(recognizer, *model, ToMetres(i.T_camera_model), overlay::PoseKind::kTruth, "", input);
  }
  for (const Estimate& e : estimates) {
    const ModelView* model = models.Find(static_cast<std::uint32_t>(e.object_id));
    if (model == nullptr || e.image_id != frame.image_id) continue;
    AddObject(recognizer, *model, ToMetres(e.T_camera_model), overlay::PoseKind::kFound,
              fmt::format("{} {:.2f}", model->name, e.score), input);
  }
  input.caption = fmt::format("simulated frame {}, poses as received over DDS", frame.image_id);
  WriteOverlay(input, arguments.overlay);
}

void RunCompare(const CompareArguments& arguments) {
  const auto models = evaluation::LoadModelSet({}, arguments.models, {});
  if (!models) throw WorkFailed(models.error());
  auto truth = evaluation::ReadTruthStream(arguments.truth, *models);
  if (!truth) throw WorkFailed(truth.error());
  const auto received = evaluation::ReadReceivedStream(arguments.received);
  if (!received) throw WorkFailed(received.error());
  // The subscriber may have joined late and left early.
  evaluation::KeepFrames(received->frames, *truth);
  if (truth->frames.empty()) {
    throw WorkFailed(
        fmt::format("{}: no received frame is in it; truth and messages must be of one run", arguments.truth.string()));
  }
  const Metrics metrics = evaluation::ComputeMetrics(*truth, received->estimates);
  for (const InstanceOutcome& o : metrics.instances) PrintOutcome(o, *models);
  for (const evaluation::FalsePositive& f : metrics.false_positives) {
    fmt::print("frame {:3}  model {}: false alarm, score {:.2f}\n", f.image_id, f.object_id, f.score);
  }
  PrintTotals(metrics);
  if (!arguments.overlay.empty()) {
    const auto frame = std::ranges::find(truth->frames, BestFrame(metrics), &FrameTruth::image_id);
    DrawReceived(arguments, *models, frame != truth->frames.end() ? *frame : truth->frames.front(),
                 received->estimates);
    fmt::print("overlay: {}\n", std::filesystem::absolute(arguments.overlay).string());
  }
  if (metrics.total.all.hits >= arguments.min_hits) return;
  throw WorkFailed(fmt::format("{}: {} objects found, at least {} expected (--min-hits)", arguments.received.string(),
                               metrics.total.all.hits, arguments.min_hits));
}

}  // namespace

void AddCompareCommand(CLI::App& app) {
  const auto arguments = std::make_shared<CompareArguments>();
  CLI::App* compare = app.add_subcommand("compare", "Compare poses received over DDS with the simulated scene's truth");
  compare->add_option("--truth", arguments->truth, "Truth that the simulated camera wrote")->required();
  compare->add_option("--received", arguments->received, "Output of 'wirepose watch --json'")->required();
  compare->add_option("--models", arguments->models, "A .wpm file or a folder of them")->required();
  compare->add_option("--min-hits", arguments->min_hits, "Fail when fewer objects were found");
  compare->add_option("--overlay", arguments->overlay, "Picture (PNG) of the received poses on the best frame");
  hal::SimulatedConfig& camera = arguments->camera;
  compare->add_option("--meshes", camera.mesh_dir, "For --overlay: the camera's mesh folder");
  compare->add_option("--scenario", camera.scenario_path, "For --overlay: the camera's scenario file");
  compare->add_option("--seed", camera.seed, "For --overlay: the camera's seed");
  compare->add_option("--frame-rate", camera.frame_rate_hz, "For --overlay: the camera's frame rate, Hz");
  compare->add_option("--samples", camera.samples_per_pixel, "For --overlay: the camera's samples per pixel");
  compare->callback([arguments] { RunCompare(*arguments); });
}

}  // namespace wirepose::cli
