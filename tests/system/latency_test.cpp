// How old a result is when a subscriber has it: the figure of docs/dds.md, all of it measured in one run.
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "robot_test_base.h"

namespace wirepose::test {
namespace {

using Json = nlohmann::json;

class LatencyTest : public RobotTest {
 protected:
  void SetUp() override {
    RobotTest::SetUp();
    const std::filesystem::path meshes = std::filesystem::path(WIREPOSE_MESH).parent_path();
    Run({WIREPOSE_PROGRAM, "sim", "render", "--out", (folder_ / "data").string(), "--models", meshes.string(),
         "--scenario", WIREPOSE_SCENARIO, "--frames", "8", "--rate", "3", "--samples", "9"});
    Run({WIREPOSE_PROGRAM, "model", "build", (meshes / "juice_dispenser.ply").string(), "--id", "3", "--out",
         (folder_ / "juice_dispenser.wpm").string()});
  }
  void Run(const std::vector<std::string>& command) const {
    Process process(folder_, "prepare", command);
    ASSERT_EQ(process.Wait(std::chrono::seconds(200)), 0) << process.Err();
  }
};

// A frame of a recorded feed counts as captured when it arrives from the camera backend; exposure and transfer are the
// camera's. 640x480, two models, 10 frames a second, subscriber in another process.
TEST_F(LatencyTest, LongCaptureToSubscriber) {
  const std::string config = WriteConfig(
      "camera:\n  backend: replay\n  replay: { data_set: data, loop: true, preload: true, frame_rate_hz: 10 }\n"
      "dds: { domain: " +
      domain_ + ", loopback: true }\nmodels: [.]\n");
  Process robot(folder_, "robot", Robot(config));
  Process subscriber(folder_, "subscriber", {WIREPOSE_TEST_SUBSCRIBER, domain_, "detections", "recognition"});
  std::this_thread::sleep_for(std::chrono::seconds(60));
  Process watch(folder_, "health", Watch({"--topic", "health", "--once"}));
  ASSERT_EQ(watch.Wait(), 0) << watch.Err() << robot.Err();
  subscriber.Signal(SIGTERM);
  ASSERT_EQ(subscriber.Wait(), 0) << subscriber.Err();

  const Json health = Json::parse(watch.OutLines().back());
  Json frame;
  for (const Json& stage : health["stage_times"]) {
    if (stage["stage"] == "frame") frame = stage;
  }
  ASSERT_FALSE(frame.is_null()) << health;
  const double recognition_p50_us = 1e-3 * frame["p50_ns"].get<double>();
  // Health tells of the last frames, the subscriber of all of them: on a machine that was busy for a while the medians
  // are of different times.
  const double recognition_p99_us = 1e-3 * frame["p99_ns"].get<double>();
  std::printf("recognition: p50 %.1f ms, p99 %.1f ms\n", 1e-3 * recognition_p50_us, 1e-3 * recognition_p99_us);
  for (const std::string& line : subscriber.OutLines()) {
    if (line[0] != '{') continue;
    const Json tally = Json::parse(line);
    std::printf("capture to subscriber, %s: %s samples, p50 %.1f ms, p99 %.1f ms, max %.1f ms\n",
                tally["topic"].get<std::string>().c_str(), tally["samples"].dump().c_str(),
                1e-3 * tally["p50_us"].get<double>(), 1e-3 * tally["p99_us"].get<double>(),
                1e-3 * tally["max_us"].get<double>());
    EXPECT_GE(tally["samples"], 550) << "of 600 frames";
    EXPECT_GT(tally["p50_us"], 0.5 * recognition_p50_us) << "the stamp is not that of the capture";
    EXPECT_LT(tally["p50_us"], recognition_p99_us + 10'000) << "the bus waits for something";
  }
  EXPECT_EQ(health["results_dropped"], 0);
  robot.Signal(SIGTERM);
  EXPECT_EQ(robot.Wait(), 0) << robot.Err();
}

}  // namespace
}  // namespace wirepose::test
