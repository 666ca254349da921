#include "stages/occlusion.h"

#include <algorithm>
#include <array>

namespace wirepose {
namespace {

// Two places on each side of the edge: those that the model's surface covers vote.
bool IsOccluded(const OcclusionParams& params, const DisparityMap& scene, const SurfaceMap& surface,
                const EdgeSample& sample) {
  constexpr std::array<float, 4> kBeside = {-9, -5, 5, 9};  // px along the normal; within 4 px the map is blurred
  int nearer = 0, votes = 0;
  for (const float offset : kBeside) {
    const int x = static_cast<int>(sample.left.x() - offset * sample.tangent.y() + 0.5F);
    const int y = static_cast<int>(sample.left.y() + offset * sample.tangent.x() + 0.5F);
    const float expected = surface.AtPixel(x, y);
    if (expected <= 0) continue;
    const float seen = scene.At(x, y);
    if (seen <= 0) continue;
    ++votes;
    if (seen > expected + std::max(params.nearer_px, params.nearer_share * expected)) ++nearer;
  }
  return 2 * nearer > votes;
}

}  // namespace

float DropOccluded(const OcclusionParams& params, const DisparityMap& scene, const SurfaceMap& surface,
                   EdgeSamples& samples) {
  std::size_t kept = 0;
  float hidden_px = 0, total_px = 0;
  for (const EdgeSample& sample : samples) {
    total_px += sample.weight_px;
    if (IsOccluded(params, scene, surface, sample)) {
      hidden_px += sample.weight_px;
    } else {
      samples[kept++] = sample;
    }
  }
  samples.resize(kept);
  return total_px > 0 ? hidden_px / total_px : 0;
}

}  // namespace wirepose
