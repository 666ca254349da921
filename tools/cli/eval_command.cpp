#include "tools/cli/eval_command.h"

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <memory>

#include <fmt/format.h>

#include "tools/cli/command.h"
#include "tools/cli/recognizer_overlay.h"
#include "tools/evaluation/candidate_log.h"
#include "tools/evaluation/evaluate.h"
#include "tools/evaluation/evaluation_json.h"
#include "tools/evaluation/report/report.h"
#include "tools/evaluation/results_csv.h"
#include "tools/evaluation/summary.h"
#include "tools/evaluation/trace_log.h"

namespace wirepose::cli {
namespace {

namespace fs = std::filesystem;

struct EvalArguments {
  evaluation::EvaluationOptions options;
  fs::path out;
  fs::path json;        // empty: none
  fs::path overlay;     // folder; empty: none
  fs::path candidates;  // empty: none
  fs::path trace;       // empty: none
  fs::path report;      // empty: none
};

// A long run must not fail at its last step.
void CheckWritable(const fs::path& file) {
  std::ofstream out(file, std::ios::app);
  if (out) return;
  throw UsageError(file.string() + ": cannot be written; name a file in an existing folder you may write to");
}

void DrawFrame(const evaluation::FrameView& view, const EvalArguments& arguments) {
  overlay::OverlayInput input = LinesOf(view.recognizer);
  for (const dataset::TrueInstance& truth : view.entry.gt) {
    const ModelView* model = view.models.Find(static_cast<std::uint32_t>(truth.obj_id));
    if (model == nullptr) continue;
    AddObject(view.recognizer, *model, truth.T_camera_model, overlay::PoseKind::kTruth, "", input);
  }
  for (const Detection& d : view.result.detections) {
    const ModelView* model = view.models.Find(d.model_id);
    if (model == nullptr || static_cast<double>(d.score) < arguments.options.min_score) continue;
    AddObject(view.recognizer, *model, d.T_camera_model, overlay::PoseKind::kFound,
              fmt::format("{} {:.2f}", model->name, d.score), input);
  }
  input.caption = fmt::format("scene {} image {}", view.entry.scene_id, view.entry.im_id);
  WriteOverlay(input, arguments.overlay / fmt::format("{:06d}_{:06d}.png", view.entry.scene_id, view.entry.im_id));
}

void ShowProgress(const evaluation::FrameView& view) {
  if (isatty(STDERR_FILENO) == 0) return;
  const bool last = view.index + 1 == view.count;
  std::fprintf(stderr, "\rframe %zu of %zu%s", view.index + 1, view.count, last ? "\n" : "");
}

void WriteJson(const fs::path& file, const evaluation::Evaluation& evaluation) {
  std::ofstream out(file);
  out << evaluation::ToJson(evaluation).dump(1) << '\n';
  out.close();
  if (!out) throw WorkFailed(file.string() + ": cannot be written; check the free space");
}

// What is written frame by frame; null where the command line did not ask for it.
struct FrameWriters {
  std::unique_ptr<evaluation::CandidateLog> candidates;
  std::unique_ptr<evaluation::TraceLog> trace;
  std::unique_ptr<evaluation::Report> report;
};

FrameWriters OpenWriters(const EvalArguments& arguments) {
  for (const fs::path& file : {arguments.out, arguments.json, arguments.candidates, arguments.options.pairs,
                               arguments.options.sets, arguments.trace, arguments.report}) {
    if (!file.empty()) CheckWritable(file);
  }
  FrameWriters writers;
  if (!arguments.candidates.empty()) {
    writers.candidates = std::make_unique<evaluation::CandidateLog>(arguments.candidates);
  }
  if (!arguments.trace.empty()) writers.trace = std::make_unique<evaluation::TraceLog>(arguments.trace);
  if (!arguments.report.empty()) writers.report = std::make_unique<evaluation::Report>(arguments.options);
  return writers;
}

void OrFail(const Result<void, std::string>& result) {
  if (!result) throw WorkFailed(result.error());
}

void RunEval(const EvalArguments& arguments) {
  const FrameWriters writers = OpenWriters(arguments);
  const auto observer = [&](const evaluation::FrameView& view) -> Result<void, std::string> {
    ShowProgress(view);
    if (!arguments.overlay.empty()) DrawFrame(view, arguments);
    if (writers.candidates) writers.candidates->Add(view);
    if (writers.trace) writers.trace->Add(view);
    return writers.report ? writers.report->Add(view) : Result<void, std::string>();
  };
  evaluation::EvaluationOptions options = arguments.options;
  options.trace = writers.trace || writers.report;
  const auto evaluation = evaluation::Evaluate(options, observer);
  if (!evaluation) throw WorkFailed(evaluation.error());
  OrFail(evaluation::WriteResults(arguments.out, evaluation->estimates));
  if (!arguments.json.empty()) WriteJson(arguments.json, *evaluation);
  if (writers.report) OrFail(writers.report->Write(*evaluation, arguments.report));
  std::fputs(evaluation::Summarize(*evaluation).c_str(), stdout);
}

}  // namespace

void AddEvalCommand(CLI::App& app) {
  const auto arguments = std::make_shared<EvalArguments>();
  CLI::App* eval = app.add_subcommand("eval", "Run the recognizer over a data set and measure what it finds");
  eval->add_option("dataset", arguments->options.dataset,
                   "Folder with models/, test/ and, unless it is of one camera with depth, calib.yaml")
      ->required();
  eval->add_option("--models", arguments->options.models,
                   "A .wpm file or a folder of them; without it DATASET/models/*.ply are compiled");
  eval->add_option("--objects", arguments->options.object_ids, "Search for these model ids only, as 1,3")
      ->delimiter(',');
  eval->add_option("--out", arguments->out, "Detections, as BOP results (CSV)")->required();
  eval->add_option("--json", arguments->json, "All measures, stage times and list use (JSON)");
  eval->add_option("--overlay", arguments->overlay, "Folder for a picture of every frame");
  eval->add_option("--candidates", arguments->candidates,
                   "All verified candidates with their evidence (CSV), to fit the score to");
  eval->add_option("--pairs", arguments->options.pairs,
                   "Corresponding pairs of lines and whether they are right (CSV), to fit their rank to");
  eval->add_option("--sets", arguments->options.sets,
                   "All promoted line sets with their evidence (CSV), to fit their rank to");
  eval->add_option("--trace", arguments->trace,
                   "The fate of every true instance, stage by stage, and why it was missed (CSV)");
  eval->add_option("--report", arguments->report,
                   "One page with everything: figures, frames, each miss and false alarm with its cause (HTML)");
  eval->add_option("--limit", arguments->options.frame_limit, "Stop after so many frames (0: all)")
      ->check([](const std::string& text) {
        return text.starts_with('-') ? std::string("must not be negative") : std::string();
      });
  eval->add_flag("--track", arguments->options.track,
                 "Follow objects over the frames of a scene, as wireposed does; without: each frame by itself");
  eval->add_option("--rate", arguments->options.rate_hz, "Frames per second of a scene's images, for --track")
      ->check(CLI::Range(0.1, 1000.0));
  eval->add_option("--min-score", arguments->options.min_score, "Drop detections below this score");
  eval->callback([arguments] { RunEval(*arguments); });
}

}  // namespace wirepose::cli
