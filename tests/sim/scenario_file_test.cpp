// Scenario files: what they say arrives, and what is wrong with them is named with line and key.
#include "sim/scenario_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "sim/scenario.h"
#include "test_scenes.h"

namespace wirepose::sim {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ScenarioFileTest : public testing::Test {
 protected:
  ScenarioFileTest()
      : folder_(fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::create_directories(folder_);
  }
  ~ScenarioFileTest() override { fs::remove_all(folder_); }

  Result<ScenarioSpec, std::string> Read(const std::string& text) const {
    std::ofstream(folder_ / "try.yaml") << text;
    return ReadScenario(folder_ / "try.yaml");
  }

  fs::path folder_;
};

TEST_F(ScenarioFileTest, WhatItSaysArrives) {
  const auto spec = Read(
      "about: a test\nseed: 7\nscenes: 3\nframes: 4\nrate_hz: 10\nsamples: 9\n"
      "room: { kind: table, worktop: [wood, stone], wall: tiles, worktop_albedo: [0.2, 0.3] }\n"
      "objects:\n"
      "  - model: [book, parcel_box]\n    count: [1, 2]\n    on: floor\n    rest: flat\n    print: plain\n"
      "    contrast: 0.05\n    visible: [0.4, 0.6]\n"
      "  - model: book\n    position_m: { x: 0.1, z: [0.2, 0.3] }\n    rotation_deg: { z: 90 }\n"
      "  - model: parcel_box\n    look_alike: true\n    scale: 0.75\n"
      "clutter: { count: 2, occluders: [1, 3] }\n"
      "camera: { rig: { width: 320, height: 240, focal_px: 262, baseline_m: 0.1 }, distance_m: [1, 2] }\n"
      "path: { kind: drive, speed_m_per_s: 0.5, shake_deg: 0.2 }\n"
      "lights: { style: lamp }\n"
      "sensor: { gamma: [1, 2.2], exposure_ms: 5, white_e: [700, 900] }\n"
      "feed:\n  stamp_jitter_us: 20\n  faults: [ { fault: offset, at: 3, frames: 2, amount: 12 } ]\n");
  ASSERT_TRUE(spec) << spec.error();
  EXPECT_EQ(spec->name, "try");
  EXPECT_EQ(spec->seed, 7U);
  EXPECT_EQ(spec->scenes * spec->frames, 12);
  EXPECT_EQ(spec->room.kind, RoomKind::kTable);
  EXPECT_EQ(spec->room.worktop, (std::vector{Texture::kWood, Texture::kStone}));
  ASSERT_EQ(spec->objects.size(), 3U);
  EXPECT_EQ(spec->objects[0].models, (std::vector<std::string>{"book", "parcel_box"}));
  EXPECT_EQ(spec->objects[0].on, Support::kFloor);
  EXPECT_EQ(spec->objects[0].contrast->high, 0.05);
  EXPECT_EQ(spec->objects[0].visible.low, 0.4);
  ASSERT_TRUE(spec->objects[1].pose);
  EXPECT_EQ(spec->objects[1].pose->position_m[2].high, 0.3);
  EXPECT_EQ(spec->objects[1].pose->rotation_deg[2].low, 90);
  EXPECT_TRUE(spec->objects[2].is_look_alike);
  EXPECT_EQ(spec->camera.calibration.width, 320);
  EXPECT_EQ(spec->camera.calibration.T_right_left.t.x(), -0.1);
  EXPECT_EQ(spec->path.kind, PathKind::kDrive);
  EXPECT_EQ(spec->lights.styles, std::vector{LightStyle::kLamp});
  EXPECT_EQ(spec->sensor.gamma.size(), 2U);
  ASSERT_EQ(spec->feed.faults.size(), 1U);
  EXPECT_EQ(spec->feed.faults[0].kind, FaultKind::kOffset);
  EXPECT_EQ(spec->feed.faults[0].amount, 12);
}

TEST_F(ScenarioFileTest, ErrorsNameFileLineAndKey) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"seed: 1\nroms: { kind: table }\n", {"try.yaml:2", "roms", "unknown key", "room"}},
      {"room:\n  kind: cellar\n", {"try.yaml:2", "room.kind", "cellar", "counter"}},
      {"objects:\n  - model: book\n  - model: book\n    count: [3, 1]\n", {"try.yaml:4", "objects[1].count", "low"}},
      {"camera: { distance_m: -1 }\n", {"try.yaml:1", "camera.distance_m", "-1"}},
      {"samples: 10\n", {"try.yaml:1", "samples", "16"}},
      {"objects: book\n", {"try.yaml:1", "objects", "list"}},
      {"objects:\n  - model: book\n    scale: 2\n", {"try.yaml:3", "scale", "look_alike"}},
      {"feed: { faults: [ { fault: offset, at: 3 } ] }\n", {"try.yaml:1", "amount"}},
      {"camera:\n  calibration: nowhere.yaml\n", {"try.yaml:2", "camera.calibration", "nowhere.yaml"}},
      {"seed: [1\n", {"try.yaml", "YAML"}},
  };
  for (const auto& [text, parts] : cases) {
    const auto spec = Read(text);
    ASSERT_FALSE(spec) << text;
    for (const std::string& part : parts) EXPECT_THAT(spec.error(), HasSubstr(part)) << text;
    EXPECT_EQ(spec.error().find('\n'), std::string::npos);
  }
  EXPECT_THAT(ReadScenario(folder_ / "absent.yaml").error(), HasSubstr("absent.yaml"));
}

TEST_F(ScenarioFileTest, FixedPosesAreKept) {
  const auto spec = Read(
      "objects:\n  - model: book\n    position_m: { x: 0.1, y: -0.05, z: 0.2 }\n    rotation_deg: { z: 90 }\n    "
      "visible: [0, 1]\n"
      "clutter: { count: 0 }\n");
  ASSERT_TRUE(spec) << spec.error();
  const auto scenario = MakeScenario(*spec, 3, test::BoxAndBook());
  ASSERT_TRUE(scenario) << scenario.error();
  const Instance& book = scenario->scene.instances.back();
  EXPECT_EQ(book.obj_id, 2);
  EXPECT_TRUE(book.T_world_object.t.isApprox(Vector3d(0.1, -0.05, 0.2)));
  EXPECT_TRUE(book.T_world_object.R.col(0).isApprox(Vector3d::UnitY()));
}

TEST(Scenarios, OfTheSuiteAreReadAndMakeAtLeastTwoHundredFrames) {
  int frames = 0;
  std::set<std::uint64_t> seeds;
  for (const char* folder : {"", "extra"}) {
    for (const auto& entry : fs::directory_iterator(fs::path(WIREPOSE_SCENARIOS) / folder)) {
      if (entry.path().extension() != ".yaml") continue;
      const auto spec = ReadScenario(entry.path());
      ASSERT_TRUE(spec) << spec.error();
      EXPECT_FALSE(spec->about.empty()) << entry.path();
      if (std::string(folder).empty()) frames += spec->scenes * spec->frames;
      for (int i = 0; i < spec->scenes; ++i) {
        EXPECT_TRUE(seeds.insert(spec->seed + static_cast<std::uint64_t>(i)).second)
            << entry.path() << ": seed " << spec->seed + static_cast<std::uint64_t>(i) << " is another scenario's, too";
      }
    }
  }
  EXPECT_GE(frames, 200);
}

}  // namespace
}  // namespace wirepose::sim
