#include "tools/evaluation/metrics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>

#include "tools/evaluation/pose_error.h"

namespace wirepose::evaluation {
namespace {

using ErrorTable = std::vector<std::vector<double>>;
using Match = std::vector<std::optional<std::size_t>>;

// One object in one frame: its instances, its detections by falling score and every error between
// them.
struct Encounter {
  const FrameTruth* frame = nullptr;
  int object_id = 0;
  const ObjectTruth* object = nullptr;          // null: detections of an object that the data set does not know
  std::vector<const InstanceTruth*> instances;  // of frame->instances
  std::vector<bool> counts;                     // by instance
  std::vector<const Estimate*> detections;      // of the span that is judged
  std::vector<std::vector<PoseError>> errors;   // [detection][instance]
};

// Errors of `rows` (detections) by `columns` (instances).
ErrorTable Select(const Encounter& e, const std::vector<std::size_t>& rows, const std::vector<std::size_t>& columns,
                  double PoseError::*field) {
  ErrorTable table;
  for (std::size_t i : rows) {
    std::vector<double>& row = table.emplace_back();
    for (std::size_t j : columns) row.push_back(e.errors[i][j].*field);
  }
  return table;
}

std::vector<std::size_t> Indices(std::size_t count) {
  std::vector<std::size_t> out(count);
  std::iota(out.begin(), out.end(), std::size_t{0});
  return out;
}

Encounter Meet(const FrameTruth& frame, int object_id, const ObjectTruth* object,
               std::vector<const Estimate*> detections, const MetricsOptions& options) {
  Encounter e;
  e.frame = &frame;
  e.object_id = object_id;
  e.object = object;
  for (const InstanceTruth& instance : frame.instances) {
    if (instance.object_id != object_id || object == nullptr) continue;
    e.instances.push_back(&instance);
    e.counts.push_back(instance.visible_fraction >= options.min_visible_fraction);
  }
  std::ranges::stable_sort(detections, std::greater<>{}, &Estimate::score);
  e.detections = std::move(detections);
  for (const Estimate* d : e.detections) {
    std::vector<PoseError>& row = e.errors.emplace_back();
    for (const InstanceTruth* i : e.instances) {
      row.push_back(MeasurePose(*object, frame.K, d->T_camera_model, i->T_camera_model));
    }
  }
  return e;
}

// BOP'19 localisation recall: of the n best estimates, n being the number of instances; estimates
// that were matched to instances that do not count are left out.
void CountThresholdHits(const Encounter& e, const Match& match, int image_width_px, ObjectScore& score) {
  std::vector<std::size_t> eligible;
  for (std::size_t j : Indices(e.instances.size())) {
    if (e.counts[j]) eligible.push_back(j);
  }
  if (eligible.empty()) return;
  std::vector<std::size_t> best;
  for (std::size_t i : Indices(e.detections.size())) {
    if (best.size() < eligible.size() && (!match[i] || e.counts[*match[i]])) best.push_back(i);
  }
  const ErrorTable mssd = Select(e, best, eligible, &PoseError::mssd_mm);
  const ErrorTable mspd = Select(e, best, eligible, &PoseError::mspd_px);
  const std::vector<bool> all(eligible.size(), true);
  const auto hits = [&](const ErrorTable& errors, double threshold) {
    const Match m = MatchGreedily(errors, threshold, all);
    return static_cast<int>(std::ranges::count_if(m, [](const auto& x) { return x.has_value(); }));
  };
  for (std::size_t k = 0; k < kThresholdCount; ++k) {
    const double step = static_cast<double>(k);
    score.mssd_hits[k] += hits(mssd, (0.05 + step * 0.05) * e.object->diameter_mm);
    score.mspd_hits[k] += hits(mspd, (5 + step * 5) * image_width_px / 640);
  }
}

HitCount* VisibilityBin(ObjectScore& score, double visible_fraction) {
  for (std::size_t b = 0; b < kVisibilityBins.size(); ++b) {
    if (kVisibilityBins[b][0] <= visible_fraction && visible_fraction < kVisibilityBins[b][1]) {
      return &score.by_visibility[b];
    }
  }
  return nullptr;
}

std::size_t PlaceOf(const Encounter& e, std::size_t j) {
  return static_cast<std::size_t>(e.instances[j] - e.frame->instances.data());
}

std::optional<double> BestMssd(const Encounter& e, std::size_t instance) {
  std::optional<double> best;
  for (const auto& row : e.errors) best = std::min(best.value_or(row[instance].mssd_mm), row[instance].mssd_mm);
  return best;
}

// The instance's line of the report; `detection` is the one that hit it.
InstanceOutcome Outcome(const Encounter& e, std::size_t j, std::optional<std::size_t> detection) {
  InstanceOutcome outcome;
  outcome.scene_id = e.frame->scene_id;
  outcome.image_id = e.frame->image_id;
  outcome.object_id = e.object_id;
  outcome.instance = PlaceOf(e, j);
  outcome.visible_fraction = e.instances[j]->visible_fraction;
  outcome.truth = e.instances[j]->T_camera_model;
  outcome.hit = detection.has_value();
  outcome.best_mssd_mm = BestMssd(e, j);
  if (!detection) return outcome;
  const PoseError& error = e.errors[*detection][j];
  outcome.truth = error.nearest_truth;
  outcome.estimate = e.detections[*detection]->T_camera_model;
  outcome.score = e.detections[*detection]->score;
  outcome.translation_mm = error.translation_mm;
  outcome.rotation_deg = error.rotation_deg;
  outcome.best_mssd_mm = error.mssd_mm;
  return outcome;
}

void CountHit(const Encounter& e, std::size_t i, std::size_t j, ObjectScore& score) {
  const PoseError& error = e.errors[i][j];
  score.translation_errors_mm.push_back(error.translation_mm);
  score.rotation_errors_deg.push_back(error.rotation_deg);
  const Estimate& d = *e.detections[i];
  if (!d.covariance || e.object->continuous) return;
  score.normalized_errors_squared.push_back(
      NormalizedErrorSquared(d.T_camera_model, error.nearest_truth, *d.covariance));
}

void CountInstances(const Encounter& e, const Match& match, ObjectScore& score, Metrics& metrics) {
  for (std::size_t j = 0; j < e.instances.size(); ++j) {
    if (!e.counts[j]) continue;
    std::optional<std::size_t> detection;
    for (std::size_t i = 0; i < match.size(); ++i) {
      if (match[i] == j) detection = i;
    }
    HitCount* bin = VisibilityBin(score, e.instances[j]->visible_fraction);
    for (HitCount* count : {&score.all, &metrics.per_scene[e.frame->scene_id], bin}) {
      if (count == nullptr) continue;
      ++count->instances;
      count->hits += detection.has_value();
    }
    if (detection) CountHit(e, *detection, j, score);
    metrics.instances.push_back(Outcome(e, j, detection));
  }
}

// Returns the number of false positives. `first` is the first of all estimates that are judged.
int CountDetections(const Encounter& e, const Match& match, const Estimate* first, ObjectScore& score,
                    Metrics& metrics) {
  int false_positives = 0;
  for (std::size_t i = 0; i < match.size(); ++i) {
    const Estimate& d = *e.detections[i];
    Judgement& judgement = metrics.judgements[static_cast<std::size_t>(&d - first)];
    judgement.verdict = Verdict::kFalse;
    if (match[i]) {
      const bool counts = e.counts[*match[i]];
      judgement = {counts ? Verdict::kHit : Verdict::kDontCare, PlaceOf(e, *match[i])};
      score.dont_care += !counts;
      continue;
    }
    ++false_positives;
    metrics.false_positives.push_back({d.scene_id, d.image_id, d.object_id, d.score, d.T_camera_model.t_mm});
  }
  score.false_positives += false_positives;
  return false_positives;
}

int CountEncounter(const Encounter& e, const Estimate* first, int image_width_px, Metrics& metrics) {
  ObjectScore& score = metrics.per_object[e.object_id];
  const double hit_mm = kHitShareOfDiameter * (e.object != nullptr ? e.object->diameter_mm : 1);
  const ErrorTable mssd = Select(e, Indices(e.detections.size()), Indices(e.instances.size()), &PoseError::mssd_mm);
  const Match match = MatchGreedily(mssd, hit_mm, e.counts);
  CountInstances(e, match, score, metrics);
  CountThresholdHits(e, match, image_width_px, score);
  return CountDetections(e, match, first, score, metrics);
}

// `first` as in CountDetections; `by_key` by scene, image and object.
struct Estimates {
  const Estimate* first = nullptr;
  std::map<std::tuple<int, int, int>, std::vector<const Estimate*>> by_key;
};

void CountFrame(const GroundTruth& truth, const FrameTruth& frame, const Estimates& estimates, Metrics& metrics) {
  std::set<int> ids;
  for (const auto& [id, object] : truth.objects) ids.insert(id);
  for (const auto& [key, list] : estimates.by_key) {
    if (std::get<0>(key) == frame.scene_id && std::get<1>(key) == frame.image_id) ids.insert(std::get<2>(key));
  }
  int false_positives = 0;
  for (int id : ids) {
    const auto found = estimates.by_key.find({frame.scene_id, frame.image_id, id});
    const auto object = truth.objects.find(id);
    const ObjectTruth* known = object != truth.objects.end() ? &object->second : nullptr;
    auto detections = found != estimates.by_key.end() ? found->second : std::vector<const Estimate*>{};
    const Encounter e = Meet(frame, id, known, std::move(detections), metrics.options);
    false_positives += CountEncounter(e, estimates.first, truth.image_width_px, metrics);
  }
  if (!frame.instances.empty()) return;
  ++metrics.negative_frames;
  metrics.negative_false_positives += false_positives;
}

RowTimes MeasureRowTimes(const GroundTruth& truth, std::span<const Estimate> estimates) {
  std::set<std::pair<int, int>> known;
  for (const FrameTruth& f : truth.frames) known.insert({f.scene_id, f.image_id});
  std::map<std::pair<int, int>, double> by_frame;
  for (const Estimate& e : estimates) {
    if (e.time_s < 0 || !known.contains({e.scene_id, e.image_id})) continue;
    double& time_s = by_frame[{e.scene_id, e.image_id}];
    time_s = std::max(time_s, e.time_s);
  }
  std::vector<double> times;
  for (const auto& [key, time_s] : by_frame) times.push_back(time_s);
  return {static_cast<int>(times.size()), Percentile(times, 0.5), Percentile(times, 0.99), Percentile(times, 1)};
}

std::optional<double> MeanShare(const std::array<int, kThresholdCount>& hits, int instances) {
  if (instances == 0) return std::nullopt;
  const double mean = std::accumulate(hits.begin(), hits.end(), 0.0) / static_cast<double>(hits.size());
  return mean / instances;
}

template <typename Container>
void Append(Container& to, const Container& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

std::optional<double> HitCount::Recall() const {
  if (instances == 0) return std::nullopt;
  return static_cast<double>(hits) / instances;
}

std::optional<double> ObjectScore::Precision() const {
  const int decided = all.hits + false_positives;
  if (decided == 0) return std::nullopt;
  return static_cast<double>(all.hits) / decided;
}

std::optional<double> ObjectScore::AverageRecallMssd() const { return MeanShare(mssd_hits, all.instances); }

std::optional<double> ObjectScore::AverageRecallMspd() const { return MeanShare(mspd_hits, all.instances); }

void ObjectScore::Add(const ObjectScore& other) {
  const auto add = [](HitCount& a, const HitCount& b) {
    a.instances += b.instances;
    a.hits += b.hits;
  };
  add(all, other.all);
  for (std::size_t b = 0; b < by_visibility.size(); ++b) add(by_visibility[b], other.by_visibility[b]);
  false_positives += other.false_positives;
  dont_care += other.dont_care;
  for (std::size_t k = 0; k < kThresholdCount; ++k) {
    mssd_hits[k] += other.mssd_hits[k];
    mspd_hits[k] += other.mspd_hits[k];
  }
  Append(translation_errors_mm, other.translation_errors_mm);
  Append(rotation_errors_deg, other.rotation_errors_deg);
  Append(normalized_errors_squared, other.normalized_errors_squared);
}

std::optional<double> Percentile(std::vector<double> values, double share) {
  if (values.empty()) return std::nullopt;
  std::ranges::sort(values);
  const double at = share * static_cast<double>(values.size() - 1);
  const std::size_t below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], at - static_cast<double>(below));
}

std::vector<std::optional<std::size_t>> MatchGreedily(const std::vector<std::vector<double>>& errors, double threshold,
                                                      const std::vector<bool>& counts) {
  Match match;
  std::vector<bool> used(counts.size(), false);
  for (const std::vector<double>& row : errors) {
    std::optional<std::size_t> best;
    const auto rank = [&](std::size_t j) { return std::tuple(!counts[j], row[j], j); };
    for (std::size_t j = 0; j < row.size(); ++j) {
      if (used[j] || !(row[j] < threshold)) continue;
      if (!best || rank(j) < rank(*best)) best = j;
    }
    if (best) used[*best] = true;
    match.push_back(best);
  }
  return match;
}

Metrics ComputeMetrics(const GroundTruth& truth, std::span<const Estimate> estimates, const MetricsOptions& options) {
  Metrics metrics;
  metrics.options = options;
  metrics.frames = static_cast<int>(truth.frames.size());
  metrics.rows = static_cast<int>(estimates.size());
  metrics.time = MeasureRowTimes(truth, estimates);
  metrics.judgements.resize(estimates.size());
  Estimates grouped{estimates.data(), {}};
  for (const Estimate& e : estimates) grouped.by_key[{e.scene_id, e.image_id, e.object_id}].push_back(&e);
  for (const auto& [id, object] : truth.objects) metrics.per_object[id];
  for (const FrameTruth& frame : truth.frames) CountFrame(truth, frame, grouped, metrics);
  for (const auto& [id, score] : metrics.per_object) metrics.total.Add(score);
  return metrics;
}

}  // namespace wirepose::evaluation
