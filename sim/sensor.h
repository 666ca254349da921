// From light to grey levels: exposure, shot noise, read noise, quantisation.
#ifndef WIREPOSE_SIM_SENSOR_H_
#define WIREPOSE_SIM_SENSOR_H_

#include <cstdint>

#include "hal/dataset/png_image.h"
#include "sim/renderer.h"

namespace wirepose::sim {

// A small machine-vision sensor: linear response, 8 bit.
struct Sensor {
  float gain = 1;             // differs between the eyes of a real rig
  float full_well_e = 10000;  // electrons that give grey level 255; 0: no noise
  float read_noise_e = 15;    // standard deviation
};

// The exposure at which the brightest 3 % of the pixels reach `target` of the full scale.
[[nodiscard]] float AutoExposure(const RadianceImage& image, float target);

// Photons to grey levels. Noise depends on `seed` and the pixel only.
[[nodiscard]] dataset::GrayImage Expose(const RadianceImage& image, float exposure, const Sensor& sensor,
                                        std::uint64_t seed);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SENSOR_H_
