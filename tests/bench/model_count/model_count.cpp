// model_count DATASET [--rounds N] [--seed S]: frame time, recall, false alarms and memory by the number of models that
// are searched for at once.
//
// The data set's own models come first; the others, up to as many as the recognizer holds, are in no scene
// (made_models.h), so that every detection of one is a false alarm. With fewer models than the data set has, these are
// searched for in groups, one after the other: every row looks for the same instances.
#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>

#include "made_models.h"
#include "tools/evaluation/evaluate.h"

namespace wirepose::bench {
namespace {

using evaluation::Estimate;
using evaluation::GroundTruth;

constexpr std::size_t kCounts[] = {1, 4, 8, 16, kMaxModels};

struct Arguments {
  std::filesystem::path dataset;
  int rounds = 5;
  std::uint32_t seed = 1;
};

template <typename T>
T OrThrow(Result<T, std::string> result) {
  if (!result) throw std::runtime_error(result.error());
  return *std::move(result);
}

void OrThrow(RecognizerError error) {
  if (error != RecognizerError::kOk) throw std::runtime_error(Describe(error));
}

Recognizer& TheRecognizer() {
  static Recognizer recognizer;
  return recognizer;
}

// What was measured with so many models at once.
struct Row {
  std::size_t models = 0;
  std::vector<std::uint32_t> selections;  // of Recognizer::SearchFor: one, or one a group
  std::vector<double> times_ms;           // processor time of every frame, selection and round
  std::vector<Estimate> estimates;        // of the first round: the others give the same
};

// Each `count` models in the order of addition, until all of the data set's `own` have been among them.
std::vector<std::uint32_t> SelectionsOf(std::size_t count, std::size_t own) {
  std::vector<std::uint32_t> selections;
  for (std::size_t first = 0; first < own; first += count) {
    selections.push_back(static_cast<std::uint32_t>(((std::uint64_t{1} << count) - 1) << first));
  }
  return selections;
}

// Adds the data set's own models and fills up with made ones; returns all files, which the recognizer reads.
std::vector<tools::CompiledModel> AddModels(evaluation::ModelSet own, std::uint32_t seed) {
  std::vector<Sides> avoided;
  for (const ModelView& model : own.views) avoided.push_back(SidesOf(model));
  if (own.views.size() > kMaxModels) OrThrow(RecognizerError::kTooManyModels);
  auto made = MakeModels(kMaxModels - own.views.size(), own.views.back().id + 1, seed, avoided);
  std::vector<tools::CompiledModel> all = std::move(own.files);
  std::ranges::move(made, std::back_inserter(all));
  for (const tools::CompiledModel& model : all) OrThrow(TheRecognizer().AddModel(model.View()));
  return all;
}

void Process(const dataset::FrameEntry& entry, const dataset::GrayImage& left, const dataset::GrayImage& right,
             bool keep, Row& row) {
  evaluation::StageClock clock;
  static RecognitionResult result;
  for (const std::uint32_t selection : row.selections) {
    TheRecognizer().SearchFor(selection);
    clock.Start();
    OrThrow(TheRecognizer().Process(left.view(), right.view(), &clock, result));
    row.times_ms.push_back(1000 * clock.Stop().total.cpu);
    if (!keep) continue;
    for (const Detection& d : result.detections) row.estimates.push_back(evaluation::ToEstimate(d, entry, 0));
  }
}

dataset::GrayImage ReadImage(const std::filesystem::path& file) {
  auto image = dataset::ReadGrayPng(file);
  if (!image) throw std::runtime_error(image.error().message);
  return *std::move(image);
}

// The rows take turns at each frame: what else the machine does meets all of them.
std::vector<Row> Measure(const dataset::Dataset& set, std::size_t own, int rounds) {
  std::vector<Row> rows;
  for (const std::size_t count : kCounts) rows.push_back({count, SelectionsOf(count, own), {}, {}});
  for (int round = 0; round < rounds; ++round) {
    for (const dataset::FrameEntry& entry : set.frames) {
      const auto left = ReadImage(entry.left_path), right = ReadImage(entry.right_path);
      for (Row& row : rows) Process(entry, left, right, round == 0, row);
    }
  }
  return rows;
}

// KiB of the recognizer and of the model files that so many models take; of several selections the mean.
struct Memory {
  double tables = 0, files = 0;
};
Memory MemoryOf(const Row& row, std::span<const tools::CompiledModel> models) {
  std::size_t file_bytes = 0;
  for (const std::uint32_t selection : row.selections) {
    for (std::size_t m = 0; m < models.size(); ++m) {
      if (((selection >> m) & 1U) != 0) file_bytes += models[m].bytes.size();
    }
  }
  constexpr std::size_t kTables = sizeof(PreparedModel) + sizeof(ModelView) + sizeof(NearTurns);
  return {static_cast<double>(row.models * kTables) / 1024,
          static_cast<double>(file_bytes) / static_cast<double>(row.selections.size()) / 1024};
}

void Print(const std::vector<Row>& rows, const GroundTruth& truth, std::span<const tools::CompiledModel> models) {
  const auto time = [](const Row& row, double share) {
    return evaluation::Percentile(row.times_ms, share).value_or(0);
  };
  std::printf(
      "| models | p50 ms | p99 ms | max ms | p50 / one's | instances | hits | recall | false, own | false, made |"
      " tables KiB | files KiB |\n|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const Row& row : rows) {
    const evaluation::Metrics metrics = evaluation::ComputeMetrics(truth, row.estimates);
    int own = 0, made = 0;
    for (const auto& [id, score] : metrics.per_object) {
      (truth.objects.contains(id) ? own : made) += score.false_positives;
    }
    const evaluation::HitCount& found = metrics.total.all;
    const Memory memory = MemoryOf(row, models);
    std::printf("| %zu | %.1f | %.1f | %.1f | %.2f | %d | %d | %.2f | %d | %d | %.0f | %.0f |\n", row.models,
                time(row, 0.5), time(row, 0.99), time(row, 1), time(row, 0.5) / time(rows.front(), 0.5),
                found.instances, found.hits, found.Recall().value_or(0), own, made, memory.tables, memory.files);
  }
  std::printf("\nThe whole recognizer is %.2f MiB, however many it searches for.\n",
              static_cast<double>(sizeof(Recognizer)) / (1 << 20));
}

void Run(const Arguments& arguments) {
  const dataset::Dataset set = OrThrow(dataset::ReadDataset(arguments.dataset));
  const GroundTruth truth = OrThrow(evaluation::ReadGroundTruth(arguments.dataset));
  evaluation::ModelSet own = OrThrow(evaluation::LoadModelSet(arguments.dataset, {}, {}));
  const std::size_t own_count = own.views.size();
  OrThrow(TheRecognizer().Configure(set.calibration));
  const std::vector<tools::CompiledModel> models = AddModels(std::move(own), arguments.seed);
  const std::vector<Row> rows = Measure(set, own_count, arguments.rounds);
  std::printf("%zu frames, %d rounds; %zu models of the data set, others made with seed %u\n\n", set.frames.size(),
              arguments.rounds, own_count, arguments.seed);
  Print(rows, truth, models);
}

}  // namespace
}  // namespace wirepose::bench

int main(int argc, char** argv) {
  wirepose::bench::Arguments arguments;
  CLI::App app{"What each further model costs"};
  app.add_option("dataset", arguments.dataset, "Stereo data set with models")->required();
  app.add_option("--rounds", arguments.rounds, "Times over all frames, for the times")->check(CLI::PositiveNumber);
  app.add_option("--seed", arguments.seed, "Of the made models");
  CLI11_PARSE(app, argc, argv);
  try {
    wirepose::bench::Run(arguments);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "model_count: %s\n", e.what());
    return 1;
  }
  return 0;
}
