// The recorded frames of tests/golden: three pairs of a simulated kitchen and the models that are
// in them.
#ifndef WIREPOSE_TESTS_GOLDEN_GOLDEN_FRAMES_H_
#define WIREPOSE_TESTS_GOLDEN_GOLDEN_FRAMES_H_

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "hal/dataset/png_image.h"
#include "sim/scenario_video.h"
#include "sim/target_mesh.h"
#include "tools/model_compiler/model_compiler.h"

namespace wirepose::testing {

inline const std::filesystem::path kGoldenFolder = WIREPOSE_GOLDEN;
inline constexpr int kGoldenFrames = 3;
inline constexpr const char* kGoldenModels[] = {"parcel_box", "book", "juice_dispenser"};

// The rig of the frames, written down here so that the frames stay readable when the simulator's
// rig changes.
inline StereoCalibration GoldenCalibration() {
  StereoCalibration c;
  c.width = 640;
  c.height = 480;
  c.left = {525.3, 525.9, 318.4, 242.1, -0.083, 0.021, 0.0004, -0.0003, 0};
  c.right = {527.0, 527.4, 322.6, 239.2, -0.080, 0.018, -0.0002, 0.0005, 0};
  c.T_right_left.R = ExpSo3({0.003, -0.004, 0.002});
  c.T_right_left.t = Vector3d(-0.1201, 0.0006, -0.0004);
  return c;
}

struct StereoImages {
  dataset::GrayImage left, right;
};

inline StereoImages GoldenFrame(int i) {
  const auto read = [i](const char* eye) {
    const auto file = kGoldenFolder / ("frame" + std::to_string(i) + "_" + eye + ".png");
    auto image = dataset::ReadGrayPng(file);
    if (!image) throw std::runtime_error(image.error().message);
    return std::move(*image);
  };
  return {read("left"), read("right")};
}

// Compiled beforehand: compiling traces rays, and the last bits of that may differ between
// processors.
inline std::vector<tools::CompiledModel> GoldenModels() {
  std::vector<tools::CompiledModel> models;
  for (const char* name : kGoldenModels) {
    auto model = tools::ReadModelFile(kGoldenFolder / (std::string(name) + ".wpm"));
    if (!model) throw std::runtime_error(model.error());
    models.push_back(std::move(*model));
  }
  return models;
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_GOLDEN_GOLDEN_FRAMES_H_
