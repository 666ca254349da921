// The examples as somebody finds them who has installed Wirepose and has no source tree.
#include <gtest/gtest.h>

#include <sstream>

#include "robot_test_base.h"

namespace wirepose::test {
namespace {

namespace fs = std::filesystem;

// An instrumented library asks the programs that link it for the same.
#ifdef __SANITIZE_ADDRESS__
constexpr const char* kFlags = "-DCMAKE_CXX_FLAGS=-fsanitize=address,undefined";
#else
constexpr const char* kFlags = "-DCMAKE_CXX_FLAGS=";
#endif

class ExampleTest : public RobotTest {
 protected:
  // The part for developers, under a prefix of its own.
  void Install() { RunCmake("install", {"--install", WIREPOSE_BUILD, "--prefix", prefix(), "--component", "dev"}); }
  // Configures and builds the installed example.
  void Build() {
    RunCmake("configure", {"-S", prefix() + "/share/wirepose/examples/cpp_subscriber", "-B", build(),
                           "-DCMAKE_PREFIX_PATH=" + prefix(), kFlags});
    RunCmake("compile", {"--build", build()});
  }
  void RunCmake(const std::string& name, const std::vector<std::string>& arguments) {
    std::vector<std::string> command = {WIREPOSE_CMAKE};
    command.insert(command.end(), arguments.begin(), arguments.end());
    Process process(folder_, name, command);
    ASSERT_EQ(process.Wait(std::chrono::seconds(120)), 0) << process.Out() << process.Err();
  }
  [[nodiscard]] std::string prefix() const { return (folder_ / "prefix").string(); }
  [[nodiscard]] std::string build() const { return (folder_ / "example").string(); }
};

TEST_F(ExampleTest, SubscriberBuildsAgainstTheInstalledPackageListensAndCommands) {
  ASSERT_NO_FATAL_FAILURE(Install());
  ASSERT_NO_FATAL_FAILURE(Build());
  std::ostringstream cache;
  cache << std::ifstream(fs::path(build()) / "CMakeCache.txt").rdbuf();
  const std::string found = cache.str();
  EXPECT_NE(found.find("Wirepose_DIR:PATH=" + prefix() + "/"), std::string::npos) << "another Wirepose was used";
  EXPECT_EQ(found.find(WIREPOSE_SOURCE), std::string::npos) << "the example needs the source tree";

  WriteDataset(3);
  Process robot(folder_, "robot", Robot(LoopingConfig()));
  const std::vector<std::string> environment = {
      "ROS_DOMAIN_ID=" + domain_,
      "CYCLONEDDS_URI=<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"lo\" multicast=\"false\"/>"
      "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</"
      "ParticipantIndex>"
      "<Peers><Peer Address=\"127.0.0.1\"/></Peers></Discovery></Domain></CycloneDDS>"};
  Process good(folder_, "good", {build() + "/wirepose_subscriber", "3", "1"}, environment);
  EXPECT_EQ(good.Wait(), 0) << good.Err() << robot.Err();
  EXPECT_EQ(good.Out().rfind("select 1: accepted\nframe ", 0), 0u) << good.Out();
  Process refused(folder_, "refused", {build() + "/wirepose_subscriber", "3", "9"}, environment);
  EXPECT_EQ(refused.Wait(), 1);
  EXPECT_NE(refused.Out().find("select 9: refused: no model file has the id 9"), std::string::npos) << refused.Out();
}

}  // namespace
}  // namespace wirepose::test
