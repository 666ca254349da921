// A recording of the running program, read back by MCAP's own library.
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "../system/robot_test_base.h"
#include "node.h"

namespace wirepose::test {
namespace {

class RecordTest : public RobotTest {
 protected:
  void SetUp() override {
    if (!NodeIsThere()) GTEST_SKIP() << "node or its packages are not to be had here; see the test npm_packages";
    RobotTest::SetUp();
    WriteDataset(3);
    robot_ = std::make_unique<Process>(folder_, "robot", Robot(LoopingConfig()));
  }
  void TearDown() override {
    if (robot_ == nullptr) return;
    robot_.reset();
    RobotTest::TearDown();
  }

  std::vector<std::string> Record(const std::vector<std::string>& more) const {
    std::vector<std::string> command = {WIREPOSE_PROGRAM, "record", "--out",     (folder_ / "out.mcap").string(),
                                        "--domain",       domain_,  "--loopback"};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }
  nlohmann::json Check() {
    Process node(folder_, "node", NodeCommand("mcap_check.mjs", {(folder_ / "out.mcap").string()}));
    EXPECT_EQ(node.Wait(), 0) << node.Err();
    return node.OutLines().empty() ? nlohmann::json() : nlohmann::json::parse(node.OutLines()[0]);
  }

  std::unique_ptr<Process> robot_;
};

TEST_F(RecordTest, EveryTopicIsThereAndDecodes) {
  Process record(folder_, "record", Record({}));
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  for (const char* const action : {"pause", "resume"}) {
    Process command(folder_, "command", {WIREPOSE_PROGRAM, "command", action, "--domain", domain_, "--loopback"});
    EXPECT_EQ(command.Wait(), 0) << command.Err();
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  record.Signal(SIGINT);
  ASSERT_EQ(record.Wait(), 0) << record.Err();
  EXPECT_NE(record.Out().find("out.mcap: "), std::string::npos) << record.Out();
  const nlohmann::json file = Check();
  ASSERT_FALSE(file.is_null());
  EXPECT_FALSE(file["topics"].contains("/wirepose/left/image_raw")) << "only with --images";
  const std::map<std::string, std::string> schemas = {{"/wirepose/detections", "vision_msgs/msg/Detection3DArray"},
                                                      {"/wirepose/markers", "visualization_msgs/msg/MarkerArray"},
                                                      {"/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"},
                                                      {"wirepose/recognition", "wirepose::Recognition"},
                                                      {"wirepose/health", "wirepose::Health"},
                                                      {"wirepose/command", "wirepose::Command"},
                                                      {"wirepose/command_status", "wirepose::CommandStatus"}};
  for (const auto& [topic, schema] : schemas) {
    ASSERT_TRUE(file["topics"].contains(topic)) << topic << " is missing: " << file;
    EXPECT_EQ(file["topics"][topic]["schema"], schema);
  }
  EXPECT_GE(file["topics"]["wirepose/recognition"]["messages"], 20);
  EXPECT_GE(file["topics"]["/wirepose/markers"]["messages"], 10) << "the recorder is a listener";
  EXPECT_EQ(file["topics"]["wirepose/command_status"]["messages"], 2);
  EXPECT_EQ(file["topics"]["wirepose/command_status"]["accepted"], true);
  EXPECT_EQ(file["topics"]["wirepose/health"]["models"], nlohmann::json::array({"parcel_box"}));
}

TEST_F(RecordTest, TopicsAndLengthCanBeChosen) {
  Process record(folder_, "record", Record({"--topic", "recognition", "--frames", "30"}));
  ASSERT_EQ(record.Wait(), 0) << record.Err();
  const nlohmann::json file = Check();
  EXPECT_EQ(file["topics"].size(), 1u);
  EXPECT_GE(file["topics"]["wirepose/recognition"]["messages"], 30);
}

TEST_F(RecordTest, ImagesComeWhenAskedFor) {
  Process record(folder_, "record", Record({"--images", "--topic", "detections", "--frames", "20"}));
  ASSERT_EQ(record.Wait(), 0) << record.Err();
  const nlohmann::json file = Check();
  EXPECT_EQ(file["topics"].size(), 2u);
  EXPECT_EQ(file["topics"]["/wirepose/left/image_raw"]["schema"], "sensor_msgs/msg/Image");
  EXPECT_GE(file["topics"]["/wirepose/left/image_raw"]["messages"], 10);
}

TEST_F(RecordTest, FailuresHaveOneLine) {
  robot_->Signal(SIGTERM);
  robot_->Wait();
  Process silent(folder_, "silent", Record({"--duration", "0.5"}));
  EXPECT_EQ(silent.Wait(), 1);
  EXPECT_NE(silent.Err().find("nothing arrived"), std::string::npos) << silent.Err();
  std::vector<std::string> nowhere = Record({"--duration", "0.5"});
  nowhere[3] = "/no/such/folder/out.mcap";
  Process unwritable(folder_, "unwritable", nowhere);
  EXPECT_EQ(unwritable.Wait(), 1);
  EXPECT_NE(unwritable.Err().find("/no/such/folder/out.mcap: cannot be written"), std::string::npos)
      << unwritable.Err();
}

}  // namespace
}  // namespace wirepose::test
