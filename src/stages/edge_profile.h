// The grey values across a predicted edge, and where they change.
#ifndef WIREPOSE_STAGES_EDGE_PROFILE_H_
#define WIREPOSE_STAGES_EDGE_PROFILE_H_

#include <array>
#include <cmath>

#include "base/fixed_vector.h"
#include "stages/edge_image.h"

namespace wirepose {

// A gradient extremum on the profile.
struct EdgePeak {
  float offset_px = 0;  // along the normal, from the predicted edge
  float gradient = 0;   // kGradientOne, signed: positive when it gets brighter along the normal
};

// Samples a smoothed image every pixel along a normal and finds its edges to sub-pixel precision.
class EdgeProfile {
 public:
  static constexpr int kMaxRange = 16;

  // Reads from p - range to p + range (px along unit `normal`, range <= kMaxRange). False when that leaves the image.
  bool Read(const SmoothPlane& plane, int width, int height, const Vector2& p, const Vector2& normal, int range);

  // Calls `use(EdgePeak)` for every local extremum of the gradient with a magnitude of at least `threshold`
  // (kGradientOne), from the lowest offset on.
  template <typename Use>
  void ForEachPeak(float threshold, const Use& use) const {
    for (int k = 2; k < count_ - 2; ++k) {
      const float here = Gradient(k);
      const float magnitude = std::abs(here);
      if (magnitude < threshold) continue;
      const float before = std::abs(Gradient(k - 1)), after = std::abs(Gradient(k + 1));
      if (magnitude < before || magnitude <= after) continue;
      const float bend = before - 2 * magnitude + after;
      use(EdgePeak{static_cast<float>(k - middle_) + 0.5F * (before - after) / bend, here});
    }
  }

  // Gradient (kGradientOne) at a whole offset within the range, from the predicted edge.
  [[nodiscard]] float GradientAt(int offset) const { return Gradient(middle_ + offset); }

 private:
  [[nodiscard]] float Gradient(int k) const { return gradient_[static_cast<std::size_t>(k)]; }

  std::array<float, (2 * kMaxRange + 5 + 7) / 8 * 8> gradient_;  // whole vectors of lanes
  int count_ = 0, middle_ = 0;
};

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_EDGE_PROFILE_H_
