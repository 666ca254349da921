// What the libcamera backend is told; free of libcamera's headers.
#ifndef WIREPOSE_HAL_LIBCAMERA_LIBCAMERA_CONFIG_H_
#define WIREPOSE_HAL_LIBCAMERA_LIBCAMERA_CONFIG_H_

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

namespace wirepose::hal {

struct StreamSettings {
  std::string pixel_format;  // libcamera's name; empty: the first of R8, NV12, YUV420, YUYV, UYVY that the camera has
  int width = 0, height = 0;
  double frame_rate_hz = 0;      // 0: the camera's own choice
  std::int32_t exposure_us = 0;  // 0: automatic
  float gain = 0;                // analogue; 0: automatic
};

struct LibcameraConfig {
  std::filesystem::path calibration_path;    // calib.yaml of the rig; its size is the size asked for
  std::string left, right;                   // a part of the camera's id or its model that no other camera has
  bool side_by_side = false;                 // `left` names one camera of double width, left image first
  StreamSettings stream;                     // size is set from the calibration
  std::chrono::microseconds max_skew{2000};  // exposures farther apart are not synchronous
};

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_LIBCAMERA_LIBCAMERA_CONFIG_H_
