// calib.yaml: the stereo calibration as OpenCV's FileStorage writes it.
#ifndef WIREPOSE_HAL_DATASET_CALIBRATION_FILE_H_
#define WIREPOSE_HAL_DATASET_CALIBRATION_FILE_H_

#include <filesystem>
#include <string>

#include "base/result.h"
#include "geometry/camera.h"

namespace wirepose::dataset {

// Reads K1 D1 K2 D2 R T image_width image_height (T in metres, x2 = R x1 + T). D holds 4 or more
// coefficients (k1 k2 p1 p2 k3 ...); non-zero ones beyond k3 are refused. Checked: shapes, finite
// numbers, positive focal lengths, no skew, R a rotation within 1e-3, a baseline between 1 mm and
// 10 m, an image of at most 16384 x 16384. The error is one line: "file:line: key: what; remedy".
// Neither throws nor crashes on any input.
[[nodiscard]] Result<StereoCalibration, std::string> ReadCalibration(const std::filesystem::path& path);

// Writes what ReadCalibration and cv::FileStorage read, with all digits: reading gives the same
// doubles back.
[[nodiscard]] Result<void, std::string> WriteCalibration(const std::filesystem::path& path,
                                                         const StereoCalibration& calibration);

}  // namespace wirepose::dataset

#endif  // WIREPOSE_HAL_DATASET_CALIBRATION_FILE_H_
