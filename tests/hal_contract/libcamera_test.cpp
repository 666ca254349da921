// What the backend says where there is no camera; the frames themselves need one (scripts/board-test).
#include <gtest/gtest.h>

#include "hal/libcamera/libcamera_camera.h"
#include "test_data.h"

namespace wirepose::hal {
namespace {

class Libcamera : public ::testing::Test {
 protected:
  [[nodiscard]] LibcameraConfig Config() const {
    LibcameraConfig config;
    config.calibration_path = folder_.path() / "calib.yaml";
    config.left = "no such camera, left";
    config.right = "no such camera, right";
    return config;
  }
  test::TemporaryFolder folder_;
};

TEST_F(Libcamera, CalibrationThatIsMissingIsNamed) {
  LibcameraCamera camera(Config());
  EXPECT_EQ(camera.Open(), CameraError::kBadData);
  EXPECT_NE(camera.detail().find("calib.yaml"), std::string_view::npos) << camera.detail();
}

TEST_F(Libcamera, CameraThatIsMissingIsNamedAndOpenCanBeTriedAgain) {
  ASSERT_TRUE(dataset::WriteCalibration(folder_.path() / "calib.yaml", test::SmallCalibration()));
  LibcameraCamera camera(Config());
  for (int attempt = 0; attempt < 2; ++attempt) {
    EXPECT_EQ(camera.Open(), CameraError::kNotFound);
    EXPECT_NE(camera.detail().find("no such camera, left"), std::string_view::npos) << camera.detail();
    EXPECT_EQ(camera.detail().find('\n'), std::string_view::npos);
  }
  EXPECT_EQ(camera.Start(), CameraError::kWrongState);
  EXPECT_EQ(camera.Close(), CameraError::kOk);
  EXPECT_EQ(camera.name(), "libcamera");
}

}  // namespace
}  // namespace wirepose::hal
