// What the simulated camera promises beyond the common contract.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "hal/simulated/simulated_camera.h"
#include "sim/scenario_video.h"
#include "test_data.h"

namespace wirepose::hal {
namespace {

using testing::HasSubstr;

class SimulatedTest : public testing::Test {
 protected:
  SimulatedTest() {
    test::WriteBoxMesh(folder_.path() / "meshes");
    (void)dataset::WriteCalibration(folder_.path() / "calib.yaml", test::SmallCalibration());
    config_.frame_count = 3;
    config_.mesh_dir = folder_.path() / "meshes";
    config_.calibration_path = folder_.path() / "calib.yaml";
    config_.samples_per_pixel = 4;
  }

  test::TemporaryFolder folder_;
  SimulatedConfig config_;
};

TEST_F(SimulatedTest, TruthFileAgreesWithTruthAndSimulator) {
  config_.truth_path = folder_.path() / "truth.jsonl";
  SimulatedCamera camera(config_);
  ASSERT_EQ(camera.Open(), CameraError::kOk) << camera.detail();
  ASSERT_EQ(camera.Start(), CameraError::kOk);
  std::vector<std::uint8_t> last_left;
  while (const auto lease = camera.AcquireFrame(std::chrono::seconds(30))) {
    const ImageView& left = (*lease)->left;
    last_left.assign(left.data, left.data + left.width * left.height);
  }
  std::istringstream lines(test::ReadText(config_.truth_path));
  std::string line;
  for (std::uint64_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(std::getline(lines, line));
    const nlohmann::json json = nlohmann::json::parse(line);
    const std::optional<SimulatedTruth> truth = camera.Truth(i);
    ASSERT_TRUE(truth);
    EXPECT_EQ(json["sequence"], i);
    EXPECT_EQ(json["capture_time_ns"], truth->capture_time.time_since_epoch().count());
    ASSERT_EQ(json["objects"].size(), truth->objects.size());
    ASSERT_GE(truth->objects.size(), 1U);
    EXPECT_EQ(json["objects"][0]["name"], "parcel_box");
    EXPECT_EQ(json["objects"][0]["t"][2], truth->objects[0].T_camera_model.t.z());
    EXPECT_EQ(json["objects"][0]["R"][1], truth->objects[0].T_camera_model.R(0, 1));
  }
  EXPECT_FALSE(std::getline(lines, line));
  EXPECT_FALSE(camera.Truth(3));

  sim::ScenarioSpec spec;
  spec.samples = 4;
  spec.camera.calibration = test::SmallCalibration();
  const auto targets = sim::LoadTargetMeshes(config_.mesh_dir);
  const auto video = sim::ScenarioVideo::Create(spec, 0, *targets);
  ASSERT_TRUE(video);
  EXPECT_EQ(video->Shoot(2).left.pixels, last_left) << "what `wirepose sim render` writes";
  EXPECT_EQ(video->Shoot(2).truth.objects[0].T_camera_object.t, camera.Truth(2)->objects[0].T_camera_model.t);
}

TEST_F(SimulatedTest, TimesOutWhileRendering) {
  config_.samples_per_pixel = 36;
  SimulatedCamera camera(config_);
  ASSERT_EQ(camera.Open(), CameraError::kOk);
  ASSERT_EQ(camera.Start(), CameraError::kOk);
  EXPECT_EQ(camera.AcquireFrame(std::chrono::nanoseconds(1)).error(), CameraError::kTimeout);
  EXPECT_EQ(camera.Stop(), CameraError::kOk);
}

TEST_F(SimulatedTest, RefusesBadConfigurations) {
  const auto open = [&](auto change) {
    SimulatedConfig config = config_;
    change(config);
    SimulatedCamera camera(config);
    const CameraError error = camera.Open();
    EXPECT_NE(camera.detail(), "");
    EXPECT_EQ(camera.detail().find('\n'), std::string_view::npos);
    return error;
  };
  EXPECT_EQ(open([](auto& c) { c.samples_per_pixel = 5; }), CameraError::kUnsupported);
  EXPECT_EQ(open([](auto& c) { c.samples_per_pixel = -4; }), CameraError::kUnsupported);
  EXPECT_EQ(open([](auto& c) { c.frame_rate_hz = 0; }), CameraError::kUnsupported);
  EXPECT_EQ(open([&](auto& c) { c.calibration_path = folder_.path() / "no.yaml"; }), CameraError::kBadData);
  std::filesystem::create_directory(folder_.path() / "empty");
  EXPECT_EQ(open([&](auto& c) { c.mesh_dir = folder_.path() / "empty"; }), CameraError::kBadData);
}

TEST_F(SimulatedTest, RefusesATruthFileThatCannotBeWritten) {
  config_.truth_path = folder_.path() / "nowhere" / "truth.jsonl";
  SimulatedCamera camera(config_);
  ASSERT_EQ(camera.Open(), CameraError::kOk);
  EXPECT_EQ(camera.Start(), CameraError::kBadData);
  EXPECT_THAT(std::string(camera.detail()), HasSubstr("nowhere"));
}

}  // namespace
}  // namespace wirepose::hal
