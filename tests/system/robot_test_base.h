// A folder with a small data set, a model and a configuration, and the programs to run on them.
#ifndef WIREPOSE_TESTS_SYSTEM_ROBOT_TEST_BASE_H_
#define WIREPOSE_TESTS_SYSTEM_ROBOT_TEST_BASE_H_

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "../dds_domain.h"
#include "hal/dataset/dataset_writer.h"
#include "process.h"

namespace wirepose::test {

inline constexpr int kWidth = 160;
inline constexpr int kHeight = 120;

inline StereoCalibration SmallRig() {
  StereoCalibration rig;
  rig.left.fx = rig.left.fy = rig.right.fx = rig.right.fy = 150;
  rig.left.cx = rig.right.cx = 79.5;
  rig.left.cy = rig.right.cy = 59.5;
  rig.T_right_left.t = {-0.1, 0, 0};
  rig.width = kWidth;
  rig.height = kHeight;
  return rig;
}

class RobotTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / ("wirepose_" + std::to_string(getpid()) + "_" + info->name());
    std::filesystem::create_directories(folder_);
    Process build(folder_, "build",
                  {WIREPOSE_PROGRAM, "model", "build", WIREPOSE_MESH, "--id", "1", "--out",
                   (folder_ / "parcel_box.wpm").string()});
    ASSERT_EQ(build.Wait(), 0) << build.Err();
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // `count` frames of scene 0, a bright square that moves.
  void WriteDataset(int count) const {
    auto writer = dataset::DatasetWriter::Create(folder_ / "data", SmallRig());
    ASSERT_TRUE(writer) << writer.error();
    for (int i = 0; i < count; ++i) {
      std::vector<std::uint8_t> pixels(std::size_t{kWidth} * kHeight, 40);
      for (int y = 30; y < 80; ++y) {
        for (int x = 40 + i; x < 100 + i; ++x) pixels[static_cast<std::size_t>(y * kWidth + x)] = 200;
      }
      const ImageView image{pixels.data(), kWidth, kHeight, kWidth};
      dataset::FrameRecord record;
      record.im_id = i;
      const auto added = writer->AddFrame(0, record, image, image, {});
      ASSERT_TRUE(added) << added.error();
    }
    const auto finished = writer->FinishScene(0);
    ASSERT_TRUE(finished) << finished.error();
  }

  [[nodiscard]] std::filesystem::path Image(int camera, const std::string& im_id) const {
    return folder_ / "data/test/000000" / ("gray_cam" + std::to_string(camera)) / (im_id + ".png");
  }

  std::string WriteConfig(const std::string& text) const {
    const std::filesystem::path file = folder_ / "robot.yaml";
    std::ofstream(file) << text;
    return file.string();
  }

  // Replay of the data set, over and over, 25 frames a second.
  [[nodiscard]] std::string LoopingConfig() const {
    return WriteConfig(
        "camera:\n  backend: replay\n  timeout_ms: 200\n"
        "  replay: { data_set: data, loop: true, frame_rate_hz: 25 }\n"
        "dds: { domain: " +
        domain_ +
        ", loopback: true, frame_id: test_optical }\n"
        "models: [parcel_box.wpm]\n");
  }

  [[nodiscard]] std::vector<std::string> Robot(const std::string& config,
                                               const std::vector<std::string>& more = {}) const {
    std::vector<std::string> command = {WIREPOSED_PROGRAM, "--config", config};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }

  [[nodiscard]] std::vector<std::string> Watch(const std::vector<std::string>& more) const {
    std::vector<std::string> command = {WIREPOSE_PROGRAM, "watch", "--json", "--domain", domain_, "--loopback"};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }

  std::filesystem::path folder_;
  DdsDomain domain_lock_;
  std::string domain_ = std::to_string(domain_lock_.id());
};

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_SYSTEM_ROBOT_TEST_BASE_H_
