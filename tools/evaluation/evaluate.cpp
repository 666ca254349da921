#include "tools/evaluation/evaluate.h"

#include <chrono>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace wirepose::evaluation {
namespace {

using Error = unexpected<std::string>;
using Outcome = Result<void, std::string>;

constexpr double kMmPerMetre = 1000;

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
  const RecognizerError error = recognizer.Configure(dataset.calibration);
  if (error != RecognizerError::kOk) {
    return Error(fmt::format("{}: {}", (dataset.root / "calib.yaml").string(), Describe(error)));
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

Result<dataset::GrayImage, std::string> ReadImage(const std::filesystem::path& file,
                                                  const StereoCalibration& calibration) {
  auto image = dataset::ReadGrayPng(file);
  if (!image) return Error(image.error().message);
  if (image->width == calibration.width && image->height == calibration.height) return std::move(*image);
  return Error(fmt::format("{}: {}x{} pixels, but calib.yaml says {}x{}; use images of the calibrated size",
                           file.string(), image->width, image->height, calibration.width, calibration.height));
}

Outcome ProcessFrame(const dataset::FrameEntry& entry, const StereoCalibration& calibration, Recognizer& recognizer,
                     Tracker* tracker, CaptureTime time, StageClock& clock, StageObserver& observer,
                     RecognitionResult& result, FrameTimes& times) {
  const auto left = ReadImage(entry.left_path, calibration);
  if (!left) return Error(left.error());
  const auto right = ReadImage(entry.right_path, calibration);
  if (!right) return Error(right.error());
  clock.Start();
  const RecognizerError error =
      ProcessTracked(recognizer, tracker, time, left->view(), right->view(), &observer, result);
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
  auto set = dataset::ReadDataset(options.dataset);
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
  Recognizer& recognizer = TheRecognizer();
  const Outcome ready = SetUp(set, models, recognizer);
  if (!ready) return Error(ready.error());
  Evaluation evaluation;
  StageClock clock;
  StageTrace trace(recognizer, &clock);
  RecognitionResult result;
  for (std::size_t i = 0; i < set.frames.size(); ++i) {
    FrameTimes times;
    trace.Start(set.frames[i].gt);
    StageObserver& stages = options.trace ? static_cast<StageObserver&>(trace) : clock;
    if (i == 0 || set.frames[i].scene_id != set.frames[i - 1].scene_id) TheTracker().Forget();
    const Outcome done =
        ProcessFrame(set.frames[i], set.calibration, recognizer, options.track ? &TheTracker() : nullptr,
                     TimeOf(set.frames[i], options.rate_hz), clock, stages, result, times);
    if (!done) return Error(done.error());
    Record(set.frames[i], result, times, options.min_score, evaluation);
    if (!observer) continue;
    const Outcome seen =
        observer({i, set.frames.size(), set.frames[i], recognizer, models, result, trace.Finish(result)});
    if (!seen) return Error(seen.error());
  }
  evaluation.truth = truth;
  evaluation.metrics = ComputeMetrics(truth, evaluation.estimates);
  return evaluation;
}

}  // namespace wirepose::evaluation
