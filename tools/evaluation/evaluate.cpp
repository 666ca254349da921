#include "tools/evaluation/evaluate.h"

#include <chrono>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "hal/dataset/depth_dataset.h"
#include "tools/evaluation/pair_log.h"
#include "tools/evaluation/set_log.h"

namespace wirepose::evaluation {
namespace {

using Error = unexpected<std::string>;
using Outcome = Result<void, std::string>;

// The robot's recognizer is static, and so is this one: same object, same memory.
Recognizer& TheRecognizer() {
  static Recognizer recognizer;
  return recognizer;
}

Tracker& TheTracker() {
  static Tracker tracker;
  return tracker;
}

// Data sets carry no times.
CaptureTime TimeOf(const dataset::FrameEntry& entry, double rate_hz) {
  return CaptureTime(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * entry.im_id / rate_hz)));
}

Outcome SetUp(const dataset::Dataset& dataset, const ModelSet& models, Recognizer& recognizer) {
  const bool depth = dataset.depth_camera.has_value();
  const RecognizerError error =
      depth ? recognizer.Configure(*dataset.depth_camera) : recognizer.Configure(dataset.calibration);
  if (error != RecognizerError::kOk) {
    const std::filesystem::path place = depth ? dataset.frames.front().left_path : dataset.root / "calib.yaml";
    return Error(fmt::format("{}: {}", place.string(), Describe(error)));
  }
  recognizer.ClearModels();
  for (const ModelView& model : models.views) {
    const RecognizerError refused = recognizer.AddModel(model);
    if (refused != RecognizerError::kOk) return Error(fmt::format("model {}: {}", model.id, Describe(refused)));
  }
  return {};
}

// A detection of an object that the truth does not list could only ever be a false alarm.
Outcome CheckIds(const ModelSet& models, const GroundTruth& truth, const std::filesystem::path& dataset) {
  for (const ModelView& model : models.views) {
    if (truth.objects.contains(static_cast<int>(model.id))) continue;
    return Error(
        fmt::format("{}: unknown model id {} (model '{}'); rebuild the model with the --id that "
                    "the data set gives it",
                    (dataset / "models" / "models_info.json").string(), model.id, model.name));
  }
  return {};
}

// One frame's images in memory: left and right, or the image and its depth.
struct FrameImages {
  dataset::GrayImage left, right;
  dataset::DepthImage depth;
};

template <typename Image>
Outcome CheckSize(const Image& image, const std::filesystem::path& file, int width, int height, const char* origin) {
  if (image.width == width && image.height == height) return {};
  return Error(fmt::format("{}: {}x{} pixels, but {} says {}x{}; use images of the calibrated size", file.string(),
                           image.width, image.height, origin, width, height));
}

Outcome ReadInto(const std::filesystem::path& file, const dataset::Dataset& set, dataset::GrayImage& out) {
  auto image = dataset::ReadGrayPng(file);
  if (!image) return Error(image.error().message);
  out = *std::move(image);
  if (set.depth_camera) {
    return CheckSize(out, file, set.depth_camera->width, set.depth_camera->height, "the first image");
  }
  return CheckSize(out, file, set.calibration.width, set.calibration.height, "calib.yaml");
}

Outcome ReadInto(const std::filesystem::path& file, const dataset::Dataset& set, dataset::DepthImage& out) {
  auto image = dataset::ReadDepthPng(file);
  if (!image) return Error(image.error().message);
  out = *std::move(image);
  return CheckSize(out, file, set.depth_camera->width, set.depth_camera->height, "the image it is registered to");
}

Outcome ReadImages(const dataset::FrameEntry& entry, const dataset::Dataset& set, FrameImages& out) {
  if (const Outcome left = ReadInto(entry.left_path, set, out.left); !left) return left;
  return set.depth_camera ? ReadInto(entry.depth_path, set, out.depth) : ReadInto(entry.right_path, set, out.right);
}

Outcome ProcessFrame(const dataset::FrameEntry& entry, const dataset::Dataset& set, Recognizer& recognizer,
                     Tracker* tracker, CaptureTime time, StageClock& clock, StageObserver& observer,
                     RecognitionResult& result, FrameTimes& times) {
  FrameImages images;
  if (const Outcome read = ReadImages(entry, set, images); !read) return read;
  const DepthView depth{images.depth.view(), static_cast<float>(entry.depth_unit_m)};
  clock.Start();
  const RecognizerError error = set.depth_camera ? recognizer.ProcessDepth(images.left.view(), depth, &observer, result)
                                                 : ProcessTracked(recognizer, tracker, time, images.left.view(),
                                                                  images.right.view(), &observer, result);
  times = clock.Stop();
  if (error == RecognizerError::kOk) return {};
  return Error(fmt::format("{}: {}", entry.left_path.string(), Describe(error)));
}

void Record(const dataset::FrameEntry& entry, const RecognitionResult& result, const FrameTimes& times,
            double min_score, Evaluation& evaluation) {
  FrameRecord& record = evaluation.frames.emplace_back();
  record.scene_id = entry.scene_id;
  record.image_id = entry.im_id;
  record.budget_hit = result.budget_hit;
  record.times = times;
  record.statistics = result.statistics;
  for (const Detection& d : result.detections) {
    if (static_cast<double>(d.score) < min_score) continue;
    ++record.detections;
    evaluation.estimates.push_back(ToEstimate(d, entry, times.total.wall));
  }
}

struct Inputs {
  dataset::Dataset dataset;
  GroundTruth truth;
  ModelSet models;
};

Result<Inputs, std::string> ReadInputs(const EvaluationOptions& options) {
  auto set = dataset::IsDepthDataset(options.dataset) ? dataset::ReadDepthDataset(options.dataset)
                                                      : dataset::ReadDataset(options.dataset);
  if (!set) return Error(set.error());
  auto truth = ReadGroundTruth(options.dataset);
  if (!truth) return Error(truth.error());
  auto models = LoadModelSet(options.dataset, options.models, options.object_ids);
  if (!models) return Error(models.error());
  const Outcome known = CheckIds(*models, *truth, options.dataset);
  if (!known) return Error(known.error());
  if (options.frame_limit > 0 && set->frames.size() > options.frame_limit) {
    set->frames.resize(options.frame_limit);
    std::set<std::pair<int, int>> kept;
    for (const dataset::FrameEntry& f : set->frames) kept.insert({f.scene_id, f.im_id});
    KeepFrames(kept, *truth);
  }
  return Inputs{std::move(*set), std::move(*truth), std::move(*models)};
}

}  // namespace

Estimate ToEstimate(const Detection& detection, const dataset::FrameEntry& entry, double time_s) {
  Estimate e;
  e.scene_id = entry.scene_id;
  e.image_id = entry.im_id;
  e.object_id = static_cast<int>(detection.model_id);
  e.score = static_cast<double>(detection.score);
  e.T_camera_model = {detection.T_camera_model.R, detection.T_camera_model.t * kMmPerMetre};
  e.time_s = time_s;
  e.covariance = detection.covariance;
  return e;
}

Result<Evaluation, std::string> Evaluate(const EvaluationOptions& options, const FrameObserver& observer) {
  const auto inputs = ReadInputs(options);
  if (!inputs) return Error(inputs.error());
  const auto& [set, truth, models] = *inputs;
  if (options.track && set.depth_camera) {
    return Error(fmt::format("{}: a camera with depth; objects are followed over stereo frames only, leave --track out",
                             set.root.string()));
  }
  Recognizer& recognizer = TheRecognizer();
  const Outcome ready = SetUp(set, models, recognizer);
  if (!ready) return Error(ready.error());
  Evaluation evaluation;
  StageClock clock;
  StageTrace trace(recognizer, &clock);
  StageObserver* stages = &clock;
  if (options.trace) stages = &trace;
  std::optional<SetLog> sets;
  if (!options.sets.empty()) stages = &sets.emplace(options.sets, recognizer, *stages, clock);
  std::optional<PairLog> pairs;
  if (!options.pairs.empty()) stages = &pairs.emplace(options.pairs, recognizer, *stages, clock);
  RecognitionResult result;
  for (std::size_t i = 0; i < set.frames.size(); ++i) {
    FrameTimes times;
    trace.Start(set.frames[i].gt);
    if (sets) sets->Start(set.frames[i]);
    if (pairs) pairs->Start(set.frames[i]);
    if (i == 0 || set.frames[i].scene_id != set.frames[i - 1].scene_id) TheTracker().Forget();
    const Outcome done = ProcessFrame(set.frames[i], set, recognizer, options.track ? &TheTracker() : nullptr,
                                      TimeOf(set.frames[i], options.rate_hz), clock, *stages, result, times);
    if (!done) return Error(done.error());
    Record(set.frames[i], result, times, options.min_score, evaluation);
    if (!observer) continue;
    const Outcome seen =
        observer({i, set.frames.size(), set.frames[i], recognizer, models, result, trace.Finish(result)});
    if (!seen) return Error(seen.error());
  }
  if (sets && !sets->ok()) return Error(options.sets.string() + ": cannot be written; check the free space");
  if (pairs && !pairs->ok()) return Error(options.pairs.string() + ": cannot be written; check the free space");
  evaluation.truth = truth;
  evaluation.metrics = ComputeMetrics(truth, evaluation.estimates);
  return evaluation;
}

}  // namespace wirepose::evaluation
