#include "sim/sensor.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "sim/random.h"

namespace wirepose::sim {
namespace {

// A Poisson number from one hash: by inversion where counts are few, else normal, which is the same
// to within a hundredth of a standard deviation.
float Poisson(float mean, std::uint64_t hash) {
  if (mean <= 0) return 0;
  constexpr float kMany = 60;
  if (mean > kMany) return mean + std::sqrt(mean) * NormalFloat(hash);
  const double u = static_cast<double>(hash >> 11) * 0x1.0p-53;
  double probability = std::exp(-double{mean}), sum = probability;
  int count = 0;
  while (sum < u && count < 4 * static_cast<int>(kMany)) {
    ++count;
    probability *= double{mean} / count;
    sum += probability;
  }
  return static_cast<float>(count);
}

// One pixel of EMVA 1288's linear camera model; the signal as a share of the full scale.
float Signal(float level, const Sensor& sensor, std::uint64_t noise, std::uint64_t pattern) {
  if (sensor.full_well_e <= 0) return level;
  float photo = std::max(level, 0.0F) * sensor.full_well_e;
  float dark = sensor.dark_e;
  if (sensor.prnu > 0) photo *= 1 + sensor.prnu * NormalFloat(pattern);
  if (sensor.dsnu_e > 0) dark += sensor.dsnu_e * NormalFloat(Mix(pattern, 1));
  const float lost = std::min(dark, 0.0F);  // an offset below zero is one of the amplifier's
  const float electrons = Poisson(photo + dark - lost, noise) + lost + sensor.read_noise_e * NormalFloat(Mix(noise, 1));
  return (electrons - sensor.dark_e) / sensor.full_well_e;
}

std::uint8_t Quantized(float signal, float gamma) {
  const float level = std::clamp(signal, 0.0F, 1.0F);
  return static_cast<std::uint8_t>(std::lround(255.0F * (gamma == 1 ? level : std::pow(level, 1 / gamma))));
}

}  // namespace

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
  const double sum = sensor.veil > 0 ? std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) : 0.0;
  const float veil = sensor.veil * static_cast<float>(sum / static_cast<double>(image.pixels.size()));
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const float level = (image.pixels[i] + veil) * exposure * sensor.gain;  // of the full scale
    out.pixels.push_back(Quantized(Signal(level, sensor, Mix(seed, i), Mix(sensor.serial, ~i)), sensor.gamma));
  }
  return out;
}

}  // namespace wirepose::sim
