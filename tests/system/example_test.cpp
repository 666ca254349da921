// The example for subscribers, built as the project of its own that it is, listens to and commands the running program.
#include <gtest/gtest.h>

#include "robot_test_base.h"

namespace wirepose::test {
namespace {

TEST_F(RobotTest, ExampleSubscriberBuildsListensAndCommands) {
  const std::string build = (folder_ / "example").string();
  Process configure(folder_, "configure", {WIREPOSE_CMAKE, "-S", WIREPOSE_EXAMPLE, "-B", build});
  ASSERT_EQ(configure.Wait(std::chrono::seconds(60)), 0) << configure.Out() << configure.Err();
  Process compile(folder_, "compile", {WIREPOSE_CMAKE, "--build", build});
  ASSERT_EQ(compile.Wait(std::chrono::seconds(120)), 0) << compile.Out() << compile.Err();

  WriteDataset(3);
  Process robot(folder_, "robot", Robot(LoopingConfig()));
  const std::vector<std::string> environment = {
      "ROS_DOMAIN_ID=" + domain_,
      "CYCLONEDDS_URI=<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"lo\" multicast=\"false\"/>"
      "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
      "<Peers><Peer Address=\"127.0.0.1\"/></Peers></Discovery></Domain></CycloneDDS>"};
  Process good(folder_, "good", {build + "/wirepose_subscriber", "3", "1"}, environment);
  EXPECT_EQ(good.Wait(), 0) << good.Err() << robot.Err();
  EXPECT_EQ(good.Out().rfind("select 1: accepted\nframe ", 0), 0u) << good.Out();
  Process refused(folder_, "refused", {build + "/wirepose_subscriber", "3", "9"}, environment);
  EXPECT_EQ(refused.Wait(), 1);
  EXPECT_NE(refused.Out().find("select 9: refused: no model file has the id 9"), std::string::npos) << refused.Out();
}

}  // namespace
}  // namespace wirepose::test
