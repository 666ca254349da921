#include "tools/evaluation/summary.h"

#include <algorithm>

#include <fmt/format.h>

#include "tools/evaluation/evaluation_json.h"

namespace wirepose::evaluation {
namespace {

std::string Cell(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

std::string Row(const std::string& name, const ObjectScore& s, int frames) {
  std::string row = fmt::format("{:>7}{:>6}{:>6}{:>6}{:>8}{:>10}{:>9.3f}", name, s.all.instances, s.all.hits,
                                s.false_positives, Cell(s.all.Recall(), 3), Cell(s.Precision(), 3),
                                static_cast<double>(s.false_positives) / std::max(1, frames));
  for (const HitCount& bin : s.by_visibility) {
    row += fmt::format("{:>10}", fmt::format("{}/{}", Cell(bin.Recall(), 2), bin.instances));
  }
  return row + fmt::format("{:>8}{:>8}{:>9}{:>9}\n", Cell(Percentile(s.translation_errors_mm, 0.5), 2),
                           Cell(Percentile(s.rotation_errors_deg, 0.5), 2), Cell(s.AverageRecallMssd(), 3),
                           Cell(s.AverageRecallMspd(), 3));
}

std::string Header() {
  std::string header = fmt::format("{:>7}{:>6}{:>6}{:>6}{:>8}{:>10}{:>9}", "object", "inst", "hit", "false", "recall",
                                   "precision", "false/fr");
  for (const auto& [low, high] : kVisibilityBins) {
    header += fmt::format("{:>10}", fmt::format("vis {:.1f}+", low));
  }
  return header + fmt::format("{:>8}{:>8}{:>9}{:>9}\n", "mm", "deg", "AR_MSSD", "AR_MSPD");
}

std::string StageTable(const nlohmann::ordered_json& stages) {
  std::string table = fmt::format("{:<18}{:>10}{:>10}{:>10}{:>10}\n", "stage [ms]", "p50", "p99", "max", "cpu p50");
  for (const auto& [name, times] : stages.items()) {
    const auto& wall = times.at("wall_ms");
    const auto cell = [](const nlohmann::ordered_json& value) {
      return value.is_null() ? std::string("-") : fmt::format("{:.3f}", value.get<double>());
    };
    table += fmt::format("{:<18}{:>10}{:>10}{:>10}{:>10}\n", name, cell(wall.at("p50")), cell(wall.at("p99")),
                         cell(wall.at("max")), cell(times.at("cpu_ms").at("p50")));
  }
  return table;
}

}  // namespace

std::string Summarize(const Evaluation& evaluation) {
  const Metrics& m = evaluation.metrics;
  std::string text = fmt::format(
      "{} frames ({} without objects), {} detections; a hit has MSSD < 0.1 diameter, visibility >= "
      "{}\n",
      m.frames, m.negative_frames, m.rows, m.options.min_visible_fraction);
  text += Header();
  for (const auto& [id, score] : m.per_object) text += Row(std::to_string(id), score, m.frames);
  text += Row("all", m.total, m.frames);
  const auto json = ToJson(evaluation);
  text += '\n';
  text += StageTable(json.at("stages"));
  for (const auto& [name, list] : json.at("lists").items()) {
    if (list.at("dropped").get<std::uint64_t>() == 0) continue;
    text += fmt::format("list {} was full ({}): {} elements dropped\n", name, list.at("capacity").get<std::uint32_t>(),
                        list.at("dropped").get<std::uint64_t>());
  }
  const auto budget_hits = json.at("budget_hits").get<int>();
  if (budget_hits > 0) text += fmt::format("{} frames stopped a search at its budget\n", budget_hits);
  return text;
}

}  // namespace wirepose::evaluation
