#include "app/stage_timer.h"

#include <algorithm>
#include <limits>

#include "base/fixed_vector.h"

namespace wirepose::app {
namespace {

// A sample is one more than the nanoseconds (0: did not run), at most what 32 bits hold (4.3 s).
void Add(StageTimer::Clock::duration time, std::uint32_t& sample) {
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(time).count();
  const std::int64_t before = sample == 0 ? 0 : sample - 1;
  sample = static_cast<std::uint32_t>(
      std::clamp<std::int64_t>(before + ns, 0, std::numeric_limits<std::uint32_t>::max() - 1) + 1);
}

// The smallest sample that at least `percent` of all are not above. Reorders `samples`.
template <typename Samples>
std::uint64_t Percentile(Samples& samples, std::size_t percent) {
  const std::size_t rank = (samples.size() * percent + 99) / 100;
  auto* const nth = samples.begin() + (rank - 1);
  std::nth_element(samples.begin(), nth, samples.end());
  return *nth;
}

}  // namespace

void StageTimer::FrameBegins(Clock::time_point now) {
  samples_[next_].fill(0);
  frame_begin_ = stage_begin_ = now;
}

void StageTimer::StageDoneAt(Stage stage, Clock::time_point now) {
  Add(now - stage_begin_, samples_[next_][static_cast<std::size_t>(stage)]);  // once a model: the sum
  stage_begin_ = now;
}

void StageTimer::FrameEnds(Clock::time_point now) {
  Add(now - frame_begin_, samples_[next_][kFrame]);
  next_ = (next_ + 1) % kWindow;
  count_ = std::min(count_ + 1, kWindow);
}

StageTimes StageTimer::Summary() const {
  StageTimes times;
  for (std::size_t stage = 0; stage <= kFrame; ++stage) {
    FixedVector<std::uint32_t, kWindow> values;
    for (std::size_t i = 0; i < count_; ++i) {
      if (samples_[i][stage] != 0) values.push_back(samples_[i][stage] - 1);
    }
    if (values.empty()) continue;
    StageTime time;
    time.stage = stage == kFrame ? "frame" : StageName(static_cast<Stage>(stage));
    time.p50_ns = Percentile(values, 50);
    time.p99_ns = Percentile(values, 99);
    time.max_ns = *std::max_element(values.begin(), values.end());
    times.push_back(time);
  }
  return times;
}

}  // namespace wirepose::app
