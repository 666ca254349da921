#include "stages/surface_evidence.h"

#include <algorithm>
#include <cmath>

namespace wirepose {
namespace {

// Largest disparity of the object within `reach` cells; 0 when it is not there.
float Nearest(const SurfaceMap& surface, int i, int j, int reach) {
  float nearest = 0;
  for (int y = std::max(surface.y0, j - reach); y <= std::min(surface.y1 - 1, j + reach); ++y) {
    for (int x = std::max(surface.x0, i - reach); x <= std::min(surface.x1 - 1, i + reach); ++x) {
      nearest = std::max(nearest, surface.At(x, y));
    }
  }
  return nearest;
}

// True when the cell and its four neighbours are the object: what lies within 4 px of the outline may be either.
bool IsInside(const SurfaceMap& s, int i, int j) {
  return i > s.x0 && j > s.y0 && i + 1 < s.x1 && j + 1 < s.y1 && s.At(i, j) > 0 && s.At(i - 1, j) > 0 &&
         s.At(i + 1, j) > 0 && s.At(i, j - 1) > 0 && s.At(i, j + 1) > 0;
}

}  // namespace

void GatherSurfaceEvidence(const SurfaceEvidenceParams& params, const DisparityMap& scene, const SurfaceMap& surface,
                           SurfaceEvidence& out) {
  constexpr int kScale = SurfaceMap::kScale;
  float on = 0, through = 0, drop = 0, level = 0, beside_before = 0;
  float off = 0, off_squared = 0;  // of the cells on the surface, in tolerances
  for (int j = surface.y0; j < surface.y1; ++j) {
    for (int i = surface.x0; i < surface.x1; ++i) {
      const float seen = scene.At(kScale * i, kScale * j);
      if (seen <= 0) continue;
      if (surface.At(i, j) > 0) {
        if (!IsInside(surface, i, j)) continue;
        const float expected = surface.At(i, j);
        const float tolerance = std::max(params.tolerance_px, params.tolerance_share * expected);
        if (seen > expected + tolerance) continue;  // hidden by something nearer
        (seen < expected - tolerance ? through : on) += 1;
        if (seen < expected - tolerance) continue;
        const float distance = (seen - expected) / tolerance;
        off += distance;
        off_squared += distance * distance;
        continue;
      }
      const float expected = Nearest(surface, i, j, 2);
      if (expected <= 0 || Nearest(surface, i, j, 1) > 0) continue;
      const float tolerance = std::max(params.drop_px, params.drop_share * expected);
      (seen < expected - tolerance ? drop : seen > expected + tolerance ? beside_before : level) += 1;
    }
  }
  const float seen = on + through + params.prior_cells;
  const float beside = drop + level + beside_before + params.prior_cells;
  // A uniform distribution within the tolerance has a variance of a third: as much as nothing known.
  const float variance =
      (off_squared - off * off / std::max(on, 1.0F) + params.prior_cells / 3) / (on + params.prior_cells);
  out = {on / seen, through / seen, drop / beside, level / beside, std::sqrt(std::max(0.0F, variance))};
}

}  // namespace wirepose
