// Whole frames: time of each stage over many frames, and the program's main.
#include <array>
#include <chrono>
#include <cstdio>

#include "bench_frame.h"

namespace wirepose::bench {
namespace {

// Time since the last stage, added up for each stage of a frame.
class StageClock final : public StageObserver {
 public:
  std::array<double, kStageCount> ms{};
  void Start() {
    ms.fill(0);
    last_ = std::chrono::steady_clock::now();
  }

 private:
  void DoStageDone(Stage stage) override {
    const auto now = std::chrono::steady_clock::now();
    ms[static_cast<std::size_t>(stage)] += std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
  }
  std::chrono::steady_clock::time_point last_;
};

RecognitionResult& Result() {
  static RecognitionResult result;
  return result;
}

void WholeFrame(benchmark::State& state) {
  Recognizer& recognizer = WarmRecognizer();
  for (auto _ : state) {
    (void)recognizer.Process(Frame().left.view(), Frame().right.view(), nullptr, Result());
    benchmark::DoNotOptimize(Result().detections.size());
  }
}
BENCHMARK(WholeFrame)->Name("recognizer/whole_frame")->Apply(WithPercentiles);

}  // namespace

Recognizer& WarmRecognizer() {
  static Recognizer recognizer;
  static const bool ready = [] {
    (void)recognizer.Configure(testing::GoldenCalibration());
    for (const auto& model : Models()) (void)recognizer.AddModel(model.View());
    (void)recognizer.Process(Frame().left.view(), Frame().right.view(), nullptr, Result());
    return true;
  }();
  (void)ready;
  return recognizer;
}

void PrintStageTable(int frames) {
  Recognizer& recognizer = WarmRecognizer();
  StageClock clock;
  std::array<std::vector<double>, kStageCount + 1> ms;
  for (int i = 0; i < frames; ++i) {
    const testing::StereoImages images = testing::GoldenFrame(i % testing::kGoldenFrames);
    clock.Start();
    (void)recognizer.Process(images.left.view(), images.right.view(), &clock, Result());
    double total = 0;
    for (std::size_t s = 0; s < kStageCount; ++s) {
      ms[s].push_back(clock.ms[s]);
      total += clock.ms[s];
    }
    ms[kStageCount].push_back(total);
  }
  std::printf("\nTime of %d frames, %zu models, ms\n%-18s %8s %8s %8s\n", frames, Models().size(), "stage", "p50",
              "p99", "max");
  for (std::size_t s = 0; s <= kStageCount; ++s) {
    std::printf("%-18s %8.3f %8.3f %8.3f\n", s == kStageCount ? "whole frame" : StageName(static_cast<Stage>(s)),
                Percentile(ms[s], 0.5), Percentile(ms[s], 0.99), Percentile(ms[s], 1));
  }
}

}  // namespace wirepose::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  wirepose::bench::PrintStageTable(90);
  std::printf("\n");
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
