// From light to grey levels after EMVA 1288 (release 4.0): photon shot noise, dark noise, fixed
// pattern, gain, quantisation; then the lens's stray light before and a gamma curve behind it.
#ifndef WIREPOSE_SIM_SENSOR_H_
#define WIREPOSE_SIM_SENSOR_H_

#include <cstdint>

#include "hal/dataset/png_image.h"
#include "sim/renderer.h"

namespace wirepose::sim {

// A machine-vision sensor, 8 bit. Electrons are those that light or heat freed, so quantum efficiency is
// in the exposure.
struct Sensor {
  float gain = 1;  // of the light, against the other eye
  float full_well_e =
      10000;                 // electrons of grey level 255: the overall gain K is 255 / full_well_e; 0: no noise at all
  float read_noise_e = 15;   // standard deviation in the dark, without the share of dark_e
  float dark_e = 0;          // mean dark signal; its mean is subtracted, its noise stays
  float prnu = 0;            // photo response non-uniformity: standard deviation, of the signal
  float dsnu_e = 0;          // dark signal non-uniformity: standard deviation
  float gamma = 1;           // grey level = 255 * (signal / full scale)^(1 / gamma)
  float veil = 0;            // stray light everywhere, as a share of the image's mean
  std::uint64_t serial = 1;  // of the sensor: its fixed pattern is the same in every frame

  // Grey levels an electron, before gamma.
  [[nodiscard]] float OverallGain() const { return 255.0F / full_well_e; }
};

// The exposure at which the brightest 3 % of the pixels reach `target` of the full scale.
[[nodiscard]] float AutoExposure(const RadianceImage& image, float target);

// Temporal noise depends on `seed` and the pixel only, the fixed pattern on `serial` and the pixel.
[[nodiscard]] dataset::GrayImage Expose(const RadianceImage& image, float exposure, const Sensor& sensor,
                                        std::uint64_t seed);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SENSOR_H_
