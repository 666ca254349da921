// From samples to pixels: the lens's point spread, the pixel's square, vignetting. Used inside this
// room only.
#ifndef WIREPOSE_SIM_FILM_H_
#define WIREPOSE_SIM_FILM_H_

#include <cstddef>
#include <vector>

#include "sim/renderer.h"

namespace wirepose::sim {

// The samples of a whole image, some pixels wider than it on each side for the point spread to draw
// from.
struct Film {
  Film(const Camera& camera, int samples_per_side);

  [[nodiscard]] float* row(int y) {
    return samples.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
  [[nodiscard]] const float* row(int y) const {
    return samples.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }

  int side;           // samples a pixel, along each axis
  int margin;         // px
  int width, height;  // samples
  std::vector<float> samples;
};

// Blurs and samples down. O(samples * point spread width).
[[nodiscard]] RadianceImage Develop(const Film& film, const Camera& camera, int threads);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_FILM_H_
