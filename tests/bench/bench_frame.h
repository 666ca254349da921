// The frame that every benchmark works on: the recorded kitchens of tests/golden, and percentiles
// for the tables.
#ifndef WIREPOSE_TESTS_BENCH_BENCH_FRAME_H_
#define WIREPOSE_TESTS_BENCH_BENCH_FRAME_H_

#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "pipeline/recognizer.h"
#include "tests/golden/golden_frames.h"

namespace wirepose::bench {

inline const testing::StereoImages& Frame() {
  static const testing::StereoImages frame = testing::GoldenFrame(2);
  return frame;
}

inline const std::vector<tools::CompiledModel>& Models() {
  static const std::vector<tools::CompiledModel> models = testing::GoldenModels();
  return models;
}

// A recognizer that has processed the frame once; its intermediates are what single stages start
// from.
Recognizer& WarmRecognizer();

// The value below which `share` of the samples lie.
inline double Percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

// Adds p50, p99 and max over repetitions to a benchmark's row.
inline void WithPercentiles(benchmark::internal::Benchmark* b) {
  b->Unit(benchmark::kMillisecond)
      ->Repetitions(15)
      ->ReportAggregatesOnly(true)
      ->ComputeStatistics("p50", [](const std::vector<double>& v) { return Percentile(v, 0.5); })
      ->ComputeStatistics("p99", [](const std::vector<double>& v) { return Percentile(v, 0.99); })
      ->ComputeStatistics("max", [](const std::vector<double>& v) { return Percentile(v, 1); });
}

void PrintStageTable(int frames);

}  // namespace wirepose::bench

#endif  // WIREPOSE_TESTS_BENCH_BENCH_FRAME_H_
