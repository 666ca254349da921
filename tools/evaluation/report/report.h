// An evaluation as one HTML file: the figures, every frame, every miss and every false alarm with its cause.
#ifndef WIREPOSE_TOOLS_EVALUATION_REPORT_REPORT_H_
#define WIREPOSE_TOOLS_EVALUATION_REPORT_REPORT_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/evaluation/evaluate.h"
#include "tools/evaluation/report/frame_note.h"

namespace wirepose::evaluation {

// Collects during Evaluate, which must run with `trace` set: causes come from the traces. About 0.15 MB a frame of
// 640 x 480. Not thread safe.
class Report {
 public:
  explicit Report(const EvaluationOptions& options) : options_(options) {}

  // From the frame observer, once a frame. Error: one line.
  Result<void, std::string> Add(const FrameView& view);

  // All the page shows, as documented in the room's README. `evaluation` is of the frames added.
  [[nodiscard]] nlohmann::ordered_json Data(const Evaluation& evaluation) const;

  // Replaces the file. Error: one line.
  Result<void, std::string> Write(const Evaluation& evaluation, const std::filesystem::path& file) const;

 private:
  EvaluationOptions options_;
  nlohmann::ordered_json objects_;  // by id: name, diameter_mm, edges
  std::vector<FrameNote> frames_;
  std::vector<ScoredDetection> candidates_;
};

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_REPORT_REPORT_H_
