#include "sim/sensor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/random.h"

namespace wirepose::sim {

float AutoExposure(const RadianceImage& image, float target) {
  std::vector<float> sorted = image.pixels;
  const auto rank = static_cast<std::ptrdiff_t>(sorted.size() * 97 / 100);
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  const float bright = sorted[static_cast<std::size_t>(rank)];
  return bright > 1e-6F ? target / bright : 1.0F;
}

dataset::GrayImage Expose(const RadianceImage& image, float exposure, const Sensor& sensor, std::uint64_t seed) {
  dataset::GrayImage out{image.width, image.height, {}};
  out.pixels.reserve(image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    float level = image.pixels[i] * exposure * sensor.gain;  // of the full scale
    if (sensor.full_well_e > 0) {
      // Shot noise is Poisson; with hundreds of electrons a normal distribution is the same thing.
      const float electrons = level * sensor.full_well_e;
      const float sigma = std::sqrt(std::max(electrons, 0.0F) + sensor.read_noise_e * sensor.read_noise_e);
      level = (electrons + sigma * NormalFloat(Mix(seed, i))) / sensor.full_well_e;
    }
    out.pixels.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(255.0F * level, 0.0F, 255.0F))));
  }
  return out;
}

}  // namespace wirepose::sim
