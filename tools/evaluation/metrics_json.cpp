#include "tools/evaluation/metrics_json.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

namespace wirepose::evaluation {
namespace {

using Json = nlohmann::ordered_json;

Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

// Chi-square quantiles, 6 degrees of freedom.
struct CoverageLevel {
  const char* name;
  double quantile;
};
constexpr CoverageLevel kCoverage[] = {
    {"50", 5.348120627447122}, {"90", 10.644640675668422}, {"95", 12.591587243743977}, {"99", 16.811893829770927}};

// Normalised estimation errors of the true positives: the mean should be 6 and the coverage what
// its name says.
Json NeesToJson(const std::vector<double>& values) {
  Json json;
  json["n"] = values.size();
  if (values.empty()) return json;
  const auto invalid = std::ranges::count_if(values, [](double v) { return v < 0; });
  json["covariance_not_positive"] = invalid;
  json["mean"] = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  json["median"] = OrNull(Percentile(values, 0.5));
  for (const CoverageLevel& level : kCoverage) {
    const auto inside = std::ranges::count_if(values, [&](double v) { return v >= 0 && v <= level.quantile; });
    json["coverage"][level.name] = static_cast<double>(inside) / static_cast<double>(values.size());
  }
  return json;
}

Json ScoreToJson(const ObjectScore& score, int frames) {
  Json json;
  json["instances"] = score.all.instances;
  json["true_positives"] = score.all.hits;
  json["false_positives"] = score.false_positives;
  json["dont_care"] = score.dont_care;
  json["recall"] = OrNull(score.all.Recall());
  json["precision"] = OrNull(score.Precision());
  json["fp_per_frame"] = static_cast<double>(score.false_positives) / std::max(1, frames);
  for (std::size_t b = 0; b < kVisibilityBins.size(); ++b) {
    const HitCount& count = score.by_visibility[b];
    const auto [low, high] = kVisibilityBins[b];
    json["recall_by_visibility"][fmt::format("{:.1f}-{:.1f}", low, std::min(high, 1.0))] = {
        {"n", count.instances}, {"recall", OrNull(count.Recall())}};
  }
  json["median_translation_mm"] = OrNull(Percentile(score.translation_errors_mm, 0.5));
  json["median_rotation_deg"] = OrNull(Percentile(score.rotation_errors_deg, 0.5));
  json["AR_MSSD"] = OrNull(score.AverageRecallMssd());
  json["AR_MSPD"] = OrNull(score.AverageRecallMspd());
  json["nees"] = NeesToJson(score.normalized_errors_squared);
  return json;
}

// Part of the translation error across the line of sight, mm.
double LateralError(const InstanceOutcome& o) {
  const Vector3d error = o.estimate.t_mm - o.truth.t_mm, sight = o.truth.t_mm.normalized();
  return (error - error.dot(sight) * sight).norm();
}

Json OutcomeToJson(const InstanceOutcome& o) {
  Json json{{"scene_id", o.scene_id}, {"im_id", o.image_id},
            {"obj_id", o.object_id},  {"visib_fract", o.visible_fraction},
            {"hit", o.hit},           {"mssd_mm", OrNull(o.best_mssd_mm)}};
  json["range_mm"] = o.truth.t_mm.norm();
  if (!o.hit) return json;
  json["score"] = o.score;
  json["translation_mm"] = o.translation_mm;
  json["lateral_mm"] = LateralError(o);
  json["rotation_deg"] = o.rotation_deg;
  return json;
}

Json FalsePositiveToJson(const FalsePositive& f) {
  return {{"scene_id", f.scene_id},
          {"im_id", f.image_id},
          {"obj_id", f.object_id},
          {"score", f.score},
          {"t_mm", {f.t_mm.x(), f.t_mm.y(), f.t_mm.z()}}};
}

}  // namespace

nlohmann::ordered_json ToJson(const Metrics& m) {
  Json json;
  json["frames"] = m.frames;
  json["negative_frames"] = m.negative_frames;
  json["fp_per_negative_frame"] =
      m.negative_frames > 0 ? Json(static_cast<double>(m.negative_false_positives) / m.negative_frames) : Json(nullptr);
  json["rows"] = m.rows;
  json["min_visib"] = m.options.min_visible_fraction;
  json["time"] = {{"frames_timed", m.time.frames},
                  {"median_s", OrNull(m.time.median_s)},
                  {"p99_s", OrNull(m.time.p99_s)},
                  {"max_s", OrNull(m.time.max_s)}};
  json["per_object"] = Json::object();
  for (const auto& [id, score] : m.per_object) json["per_object"][std::to_string(id)] = ScoreToJson(score, m.frames);
  json["per_scene"] = Json::object();
  for (const auto& [id, count] : m.per_scene) {
    json["per_scene"][std::to_string(id)] = {{"n", count.instances}, {"recall", OrNull(count.Recall())}};
  }
  json["total"] = ScoreToJson(m.total, m.frames);
  json["instances"] = Json::array();
  for (const InstanceOutcome& o : m.instances) json["instances"].push_back(OutcomeToJson(o));
  json["false_positives"] = Json::array();
  for (const FalsePositive& f : m.false_positives) json["false_positives"].push_back(FalsePositiveToJson(f));
  return json;
}

}  // namespace wirepose::evaluation
