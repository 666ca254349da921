#include "stages/edge_line.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace wirepose {
namespace {

constexpr float kSaturation = 8;  // thresholds: beyond this, strength adds nothing

float Strength(const EdgePeak& peak, float threshold) {
  return std::min(std::abs(peak.gradient), kSaturation * threshold);
}

// Votes of one sample for the whole offsets of the range, for a line that darkens and one that brightens.
struct SampleVotes {
  std::array<std::array<float, 2 * EdgeProfile::kMaxRange + 1>, 2> at{};

  void Add(const EdgeLineParams& params, const EdgePeak& peak, int range, float threshold) {
    const float vote = params.presence + (1 - params.presence) * Strength(peak, threshold) / (kSaturation * threshold);
    const auto low = static_cast<int>(std::ceil(peak.offset_px - params.width_px));
    const auto high = static_cast<int>(std::floor(peak.offset_px + params.width_px));
    for (int offset = std::max(-range, low); offset <= std::min(range, high); ++offset) {
      const float here = vote * (1 - std::abs(static_cast<float>(offset) - peak.offset_px) / params.width_px);
      const auto place = static_cast<std::size_t>(offset + range), same = peak.gradient > 0 ? std::size_t{1} : 0;
      at[same][place] = std::max(at[same][place], here);
      at[1 - same][place] = std::max(at[1 - same][place], params.other_vote * here);
    }
  }
};

constexpr int kMaxSteps = EdgeProfile::kMaxRange;  // to each side, of at least one pixel
constexpr auto kMaxPlaces = static_cast<std::size_t>(2 * kMaxSteps + 1);

}  // namespace

void SamplePeaks::Add(const EdgePeak& peak) {
  if (peaks.try_push_back(peak)) return;
  const auto weaker = [](const EdgePeak& a, const EdgePeak& b) { return std::abs(a.gradient) < std::abs(b.gradient); };
  EdgePeak& weakest = *std::min_element(peaks.begin(), peaks.end(), weaker);
  if (weaker(weakest, peak)) weakest = peak;
}

float PeakScore(const EdgePeak& peak, float at, float reach, float threshold) {
  const float distance = std::abs(peak.offset_px - at);
  return distance > reach ? 0 : Strength(peak, threshold) * (1 - 0.7F * distance / (reach + 1));
}

EdgeLine FindEdgeLine(const EdgeLineParams& params, const EdgePeaks& edge, int range, float threshold) {
  const float step = std::max(1.0F, params.step_px);
  const int n = std::min(kMaxSteps, static_cast<int>(static_cast<float>(range) / step));
  // Few samples determine no direction.
  const int most_turn = edge.size() < 4 ? 0 : n;
  std::array<std::array<std::array<float, 2>, kMaxPlaces>, kMaxPlaces> votes;
  const auto for_each_line = [&](const auto& use) {
    for (int i = -n; i <= n; ++i) {
      for (int j = std::max(-n, i - most_turn); j <= std::min(n, i + most_turn); ++j) {
        use(EdgeLine{step * static_cast<float>(i), step * static_cast<float>(j), false},
            votes[static_cast<std::size_t>(i + n)][static_cast<std::size_t>(j + n)]);
      }
    }
  };
  for_each_line([](const EdgeLine&, std::array<float, 2>& sum) { sum = {0, 0}; });
  const float part = edge.size() > 1 ? 1 / static_cast<float>(edge.size() - 1) : 0.0F;
  for (std::size_t k = 0; k < edge.size(); ++k) {
    SampleVotes sample;
    for (const EdgePeak& peak : edge[k].peaks) sample.Add(params, peak, range, threshold);
    const float share = static_cast<float>(k) * part;
    for_each_line([&](const EdgeLine& line, std::array<float, 2>& sum) {
      const auto place = static_cast<std::size_t>(line.At(share) + static_cast<float>(range) + 0.5F);
      sum[0] += sample.at[0][place];
      sum[1] += sample.at[1][place];
    });
  }
  EdgeLine best;
  float most = 0;
  for_each_line([&](EdgeLine line, const std::array<float, 2>& sum) {
    const float away = 0.5F * (std::abs(line.first_px) + std::abs(line.last_px)) / static_cast<float>(range + 1);
    for (const bool brightens : {false, true}) {
      const float total = sum[brightens ? 1 : 0] * (1 - params.far_loss * away);
      if (total <= most) continue;
      most = total;
      line.brightens = brightens;
      best = line;
    }
  });
  return best;
}

}  // namespace wirepose
