#include "tools/evaluation/report/report.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "tools/evaluation/evaluation_json.h"
#include "tools/evaluation/report/html_page.h"

namespace wirepose::evaluation {
namespace {

using Json = nlohmann::ordered_json;
using FrameKey = std::pair<int, int>;
using InstanceKey = std::pair<FrameKey, std::size_t>;

const char* VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kHit:
      return "hit";
    case Verdict::kFalse:
      return "false";
    case Verdict::kDontCare:
      return "don't care";
    case Verdict::kUnknownFrame:
      return "unknown frame";
  }
  return "?";
}

Json DetectionToJson(const DetectionNote& note, const Judgement& judgement, const FrameKey& frame,
                     const std::set<InstanceKey>& found) {
  Json json = note.json;
  json["verdict"] = VerdictName(judgement.verdict);
  if (judgement.verdict != Verdict::kFalse) {
    json["instance"] = judgement.instance;
    return json;
  }
  const AlarmFacts& facts = note.facts;
  const bool taken = facts.nearest && found.contains({frame, *facts.nearest});
  json["cause"] = CauseName(CauseOf(facts, taken));
  const auto index = [](const std::optional<std::size_t>& i) { return i ? Json(*i) : Json(nullptr); };
  json["nearest"] = index(facts.nearest);
  json["nearest_error_d"] = facts.nearest_error_d;
  json["covered"] = index(facts.covered);
  json["range_ratio"] = facts.range_ratio;
  json["other"] = index(facts.other);
  return json;
}

// Instances that a detection was matched to, those that do not count included.
std::set<InstanceKey> FoundInstances(const Evaluation& evaluation) {
  std::set<InstanceKey> found;
  for (std::size_t i = 0; i < evaluation.estimates.size(); ++i) {
    const Estimate& e = evaluation.estimates[i];
    const Judgement& judgement = evaluation.metrics.judgements[i];
    if (judgement.verdict == Verdict::kHit || judgement.verdict == Verdict::kDontCare) {
      found.insert({{e.scene_id, e.image_id}, judgement.instance});
    }
  }
  return found;
}

void AddOutcomes(const Metrics& metrics, const FrameKey& frame, Json& instances) {
  for (Json& instance : instances) instance["counts"] = false;
  for (const InstanceOutcome& o : metrics.instances) {
    if (FrameKey(o.scene_id, o.image_id) != frame) continue;
    Json& instance = instances[o.instance];
    instance["counts"] = true;
    instance["hit"] = o.hit;
    instance["mssd_mm"] = o.best_mssd_mm ? Json(*o.best_mssd_mm) : Json(nullptr);
    if (!o.hit) continue;
    instance["score"] = o.score;
    instance["translation_mm"] = o.translation_mm;
    instance["rotation_deg"] = o.rotation_deg;
  }
}

// Without what the frames say themselves.
Json Measures(const Evaluation& evaluation) {
  Json json = ToJson(evaluation);
  for (const char* repeated : {"instances", "false_positives"}) json.erase(repeated);
  json["errors"] = {{"translation_mm", evaluation.metrics.total.translation_errors_mm},
                    {"rotation_deg", evaluation.metrics.total.rotation_errors_deg},
                    {"nees", evaluation.metrics.total.normalized_errors_squared}};
  return json;
}

// The score curve as it would go on below the threshold of what is reported. Candidates above it were not left out for
// their score.
Json ContinuedCurve(const Evaluation& evaluation, const std::vector<FrameNote>& frames) {
  std::vector<Estimate> all = evaluation.estimates;
  double lowest = 1;
  for (const Estimate& estimate : all) lowest = std::min(lowest, static_cast<double>(estimate.score));
  const auto is_below = [&](const Estimate& e) { return static_cast<double>(e.score) < lowest; };
  for (const FrameNote& note : frames) {
    std::copy_if(note.unreported.begin(), note.unreported.end(), std::back_inserter(all), is_below);
  }
  const Metrics metrics = ComputeMetrics(evaluation.truth, all);
  return ToJson(ScoreCurve(CountedDetections(all, metrics), metrics.total.all.instances));
}

std::string NameOf(const std::filesystem::path& dataset) {
  const std::filesystem::path absolute = std::filesystem::absolute(dataset).lexically_normal();
  return absolute.has_filename() ? absolute.filename().string() : absolute.parent_path().filename().string();
}

}  // namespace

Result<void, std::string> Report::Add(const FrameView& view) {
  auto note = TakeNote(view, options_.min_score);
  if (!note) return unexpected<std::string>(note.error());
  frames_.push_back(std::move(*note));
  for (const ScoredDetection& c : ScoredCandidates(view, MetricsOptions().min_visible_fraction))
    candidates_.push_back(c);
  if (!objects_.is_null()) return {};
  for (const ModelView& model : view.models.views) {
    objects_[std::to_string(model.id)] = {{"name", model.name},
                                          {"diameter_mm", 1000 * static_cast<double>(model.diameter_m)},
                                          {"edges", model.edges.size()}};
  }
  return {};
}

Json Report::Data(const Evaluation& evaluation) const {
  Json data{{"dataset", NameOf(options_.dataset)}, {"min_score", options_.min_score}, {"objects", objects_}};
  data["measures"] = Measures(evaluation);
  data["measures"]["candidate_calibration"] = ToJson(MeasureReliability(candidates_));
  data["measures"]["continued_curve"] = ContinuedCurve(evaluation, frames_);
  data["frames"] = Json::array();
  const std::set<InstanceKey> found = FoundInstances(evaluation);
  std::size_t row = 0;  // detections were noted in the order of the estimates
  for (const FrameNote& note : frames_) {
    const FrameKey key(note.json.at("scene"), note.json.at("image"));
    Json frame = note.json;
    frame["detections"] = Json::array();
    for (const DetectionNote& d : note.detections) {
      frame["detections"].push_back(DetectionToJson(d, evaluation.metrics.judgements[row++], key, found));
    }
    frame["instances"] = note.instances;
    AddOutcomes(evaluation.metrics, key, frame["instances"]);
    data["frames"].push_back(std::move(frame));
  }
  return data;
}

Result<void, std::string> Report::Write(const Evaluation& evaluation, const std::filesystem::path& file) const {
  std::ofstream out(file, std::ios::binary);
  out << MakePage(NameOf(options_.dataset), Data(evaluation));
  out.close();
  if (out) return {};
  return unexpected<std::string>(fmt::format("{}: cannot be written; check the free space", file.string()));
}

}  // namespace wirepose::evaluation
