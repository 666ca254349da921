#include "tools/evaluation/evaluation_json.h"

#include <algorithm>

#include "tools/evaluation/metrics_json.h"

namespace wirepose::evaluation {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMsPerSecond = 1000;

Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json Spread(const std::vector<double>& values) {
  return {{"p50", OrNull(Percentile(values, 0.5))},
          {"p99", OrNull(Percentile(values, 0.99))},
          {"max", OrNull(Percentile(values, 1))}};
}

// `pick` takes the Seconds of one stage, or of the whole, out of a frame's times.
template <typename Pick>
Json SpreadOf(const std::vector<FrameRecord>& frames, Pick pick) {
  std::vector<double> wall, cpu;
  for (const FrameRecord& f : frames) {
    const Seconds seconds = pick(f.times);
    wall.push_back(seconds.wall * kMsPerSecond);
    cpu.push_back(seconds.cpu * kMsPerSecond);
  }
  return {{"wall_ms", Spread(wall)}, {"cpu_ms", Spread(cpu)}};
}

Json StagesToJson(const std::vector<FrameRecord>& frames) {
  Json json;
  for (std::size_t s = 0; s < kStageCount; ++s) {
    json[StageName(static_cast<Stage>(s))] = SpreadOf(frames, [s](const FrameTimes& t) { return t.stages[s]; });
  }
  json["frame"] = SpreadOf(frames, [](const FrameTimes& t) { return t.total; });
  return json;
}

Json ListsToJson(const std::vector<FrameRecord>& frames) {
  Json json;
  for (const auto& [name, use] : kRecognitionLists) {
    std::uint32_t capacity = 0, high_water = 0;
    std::uint64_t dropped = 0;
    std::vector<double> used;
    for (const FrameRecord& f : frames) {
      const ListUse& list = f.statistics.*use;
      capacity = std::max(capacity, list.capacity);
      high_water = std::max(high_water, list.used);
      dropped += list.dropped;
      used.push_back(list.used);
    }
    json[name] = {{"capacity", capacity},
                  {"high_water", high_water},
                  {"p50", OrNull(Percentile(used, 0.5))},
                  {"dropped", dropped}};
  }
  return json;
}

Json FrameToJson(const FrameRecord& f) {
  Json json{{"scene_id", f.scene_id},     {"im_id", f.image_id},        {"time_s", f.times.total.wall},
            {"cpu_s", f.times.total.cpu}, {"detections", f.detections}, {"budget_hit", f.budget_hit}};
  for (std::size_t s = 0; s < kStageCount; ++s) {
    json["stages_ms"][StageName(static_cast<Stage>(s))] = f.times.stages[s].wall * kMsPerSecond;
  }
  for (const auto& [name, use] : kRecognitionLists) {
    json["lists"][name] = {{"used", (f.statistics.*use).used}, {"dropped", (f.statistics.*use).dropped}};
  }
  return json;
}

}  // namespace

nlohmann::ordered_json ToJson(const Reliability& reliability) {
  Json json{{"expected_error", OrNull(reliability.expected_error)}, {"bins", Json::array()}};
  for (const ReliabilityBin& bin : reliability.bins) {
    if (bin.count == 0) continue;
    json["bins"].push_back({{"low", bin.low},
                            {"high", bin.high},
                            {"n", bin.count},
                            {"mean_score", bin.mean_score},
                            {"share_right", bin.share_right},
                            {"interval", {bin.share_low, bin.share_high}}});
  }
  return json;
}

nlohmann::ordered_json ToJson(const std::vector<CurvePoint>& curve) {
  Json json = Json::array();
  for (const CurvePoint& p : curve) {
    json.push_back({{"threshold", p.threshold}, {"precision", p.precision}, {"recall", p.recall}});
  }
  return json;
}

nlohmann::ordered_json ToJson(const Evaluation& evaluation) {
  Json json = ToJson(evaluation.metrics);
  const auto counted = CountedDetections(evaluation.estimates, evaluation.metrics);
  json["calibration"] = ToJson(MeasureReliability(counted));
  json["score_curve"] = ToJson(ScoreCurve(counted, evaluation.metrics.total.all.instances));
  json["stages"] = StagesToJson(evaluation.frames);
  json["lists"] = ListsToJson(evaluation.frames);
  json["budget_hits"] = std::ranges::count(evaluation.frames, true, &FrameRecord::budget_hit);
  json["per_frame"] = Json::array();
  for (const FrameRecord& f : evaluation.frames) json["per_frame"].push_back(FrameToJson(f));
  return json;
}

}  // namespace wirepose::evaluation
