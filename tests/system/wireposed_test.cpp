// The robot program and a subscriber as two processes over loopback.
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "publish/dds_pool.h"
#include "robot_test_base.h"

namespace wirepose::test {
namespace {

using Json = nlohmann::json;

// Of a process that may still be writing its last line.
std::vector<Json> Messages(const Process& watch, const std::string& topic) {
  std::vector<Json> messages;
  for (const std::string& line : watch.OutLines()) {
    Json message = Json::parse(line, nullptr, false);
    if (message.is_discarded()) break;
    if (message["topic"] == topic) messages.push_back(std::move(message));
  }
  return messages;
}

class WireposedTest : public RobotTest {};

TEST_F(WireposedTest, SubscriberInAnotherProcessGetsEveryTopic) {
  WriteDataset(3);
  Process robot(folder_, "robot", Robot(LoopingConfig()));
  Process both(folder_, "both", Watch({"--frames", "5", "--timeout", "20"}));
  Process ros(folder_, "ros", Watch({"--topic", "detections", "--once", "--timeout", "20"}));
  ASSERT_EQ(both.Wait(), 0) << both.Err() << robot.Err();
  ASSERT_EQ(ros.Wait(), 0) << ros.Err() << robot.Err();

  const std::vector<Json> recognition = Messages(both, "recognition");
  ASSERT_EQ(recognition.size(), 5u);
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_EQ(recognition[i]["frame_sequence"], recognition[i - 1]["frame_sequence"].get<int>() + 1);
    EXPECT_EQ(recognition[i]["capture_time_ns"],
              recognition[i - 1]["capture_time_ns"].get<std::int64_t>() + 40'000'000);
    EXPECT_EQ(recognition[i]["frame_id"], "test_optical");
  }
  const std::vector<Json> health = Messages(both, "health");
  ASSERT_FALSE(health.empty()) << "health is transient-local: who comes late gets the last one";
  EXPECT_EQ(health.back()["camera"], "replay");
  ASSERT_EQ(health.back()["models"].size(), 1u);
  EXPECT_EQ(health.back()["models"][0]["name"], "parcel_box");
  EXPECT_NE(health.back()["models"][0]["checksum"], 0);
  const Json& pool = health.back()["pool"];
  EXPECT_GT(pool["high_water_bytes"], 100 << 10) << "DDS works in the static pool, and health says how much of it";
  EXPECT_GE(pool["high_water_bytes"], pool["used_bytes"]);
  EXPECT_NEAR(pool["capacity_bytes"].get<double>(), static_cast<double>(kDefaultDdsPoolBytes), 100);
  EXPECT_EQ(Messages(ros, "detections").at(0)["header"]["frame_id"], "test_optical");
}

TEST_F(WireposedTest, TerminationIsCleanAndIsTheLastThingHealthSays) {
  WriteDataset(2);
  Process robot(folder_, "robot", Robot(LoopingConfig()));
  // Runs until nothing has come for 2 s: health comes once a second.
  Process watch(folder_, "watch", Watch({"--topic", "health", "--timeout", "2"}));
  for (int i = 0; i < 400 && Messages(watch, "health").empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  robot.Signal(SIGTERM);
  EXPECT_EQ(robot.Wait(), 0) << robot.Err();
  EXPECT_EQ(watch.Wait(), 1) << "silence after the end";
  ASSERT_FALSE(Messages(watch, "health").empty()) << watch.Err();
  EXPECT_EQ(Messages(watch, "health").back()["state"], "stopped");
}

// What a person at the live table is told of the bus: broken promises, a program that died, its successor.
TEST_F(WireposedTest, WatchTellsMissedDeadlinesAndLostLiveliness) {
  WriteDataset(2);
  const std::string config = WriteConfig(
      "camera:\n  backend: replay\n  replay: { data_set: data, loop: true, frame_rate_hz: 25 }\n"
      "dds:\n  domain: " +
      domain_ + "\n  loopback: true\n  topics: { recognition: { deadline_ms: 300 } }\nmodels: [parcel_box.wpm]\n");
  // Silence for 2 s instead of 10 is death.
  const std::vector<std::string> lease = {
      "CYCLONEDDS_URI=<CycloneDDS><Domain><Discovery><LeaseDuration>2 s</LeaseDuration></Discovery></Domain>"
      "</CycloneDDS>"};
  auto robot = std::make_unique<Process>(folder_, "robot", Robot(config), lease);
  // On a terminal.
  Process watch(folder_, "watch",
                {"/usr/bin/script", "-qfec", WIREPOSE_PROGRAM " watch --deadline 300 --loopback --domain " + domain_,
                 "/dev/null"});
  // Is it there, in the newest picture that says `before`, below that? Notes stay for a while, the newest at the
  // bottom.
  const auto told = [&](const std::string& text, const std::string& before = "") {
    for (int i = 0; i < 1500; ++i) {
      const std::string out = watch.Out();
      const std::size_t at = before.empty() ? 0 : out.rfind(before);
      if (at != std::string::npos && out.find(text, at) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  };
  ASSERT_TRUE(told("a publisher is there")) << watch.Out() << robot->Err();
  // Only what has been heard once can be missed: the first frame's latency is shown.
  ASSERT_TRUE(told(" ms")) << watch.Out();
  robot->Signal(SIGSTOP);
  EXPECT_TRUE(told("deadlines missed"));
  robot->Signal(SIGKILL);
  EXPECT_TRUE(told("the publisher is gone"));
  robot = std::make_unique<Process>(folder_, "successor", Robot(config), lease);
  EXPECT_TRUE(told("a publisher is there", "the publisher is gone")) << robot->Err();
}

TEST_F(WireposedTest, InterruptEndsItToo) {
  WriteDataset(2);
  Process robot(folder_, "robot", Robot(LoopingConfig()));
  for (int i = 0; i < 400 && robot.Err().find("running") == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  robot.Signal(SIGINT);
  EXPECT_EQ(robot.Wait(), 0) << robot.Err();
  EXPECT_NE(robot.Err().find("stopped after"), std::string::npos) << robot.Err();
}

TEST_F(WireposedTest, BadFramesAreReportedAndTheProgramGoesOn) {
  WriteDataset(4);
  std::ofstream(Image(1, "000001")) << "this is no picture";
  std::filesystem::remove(Image(2, "000002"));
  Process robot(folder_, "robot", Robot(LoopingConfig()));
  Process watch(folder_, "watch", Watch({"--frames", "12", "--timeout", "20"}));
  ASSERT_EQ(watch.Wait(), 0) << watch.Err() << robot.Err();
  EXPECT_EQ(robot.Wait(std::chrono::seconds(0)), std::nullopt) << "died: " << robot.Err();

  for (const Json& message : Messages(watch, "recognition")) {
    const int image = message["frame_sequence"].get<int>() % 4;
    EXPECT_TRUE(image == 0 || image == 3) << "a bad frame was used: " << message.dump();
  }
  bool damaged = false;
  bool missing = false;
  for (const Json& health : Messages(watch, "health")) {
    if (health["state"] != "bad_frames") continue;
    EXPECT_NE(health["last_error"], "");
    damaged |= health["camera_status"] == "image damaged" && health["frames"]["damaged"] > 0;
    missing |= health["camera_status"] == "image missing" && health["frames"]["missing"] > 0;
  }
  EXPECT_TRUE(damaged) << watch.Out();
  EXPECT_TRUE(missing) << watch.Out();
}

TEST_F(WireposedTest, EndsAfterTheFramesAskedFor) {
  WriteDataset(2);
  Process robot(folder_, "robot", Robot(LoopingConfig(), {"--frames", "5"}));
  EXPECT_EQ(robot.Wait(), 0);
  EXPECT_NE(robot.Err().find("stopped after 5 frames"), std::string::npos) << robot.Err();
}

TEST_F(WireposedTest, EndsWithTheRecording) {
  WriteDataset(3);
  const std::string config = WriteConfig(
      "camera: { backend: replay, replay: { data_set: data } }\n"
      "dds: { domain: " +
      domain_ + ", loopback: true }\nmodels: [.]\n");
  Process robot(folder_, "robot", Robot(config));
  EXPECT_EQ(robot.Wait(), 0);
  EXPECT_NE(robot.Err().find("stopped after 3 frames"), std::string::npos) << robot.Err();
}

TEST_F(WireposedTest, SimulatedCameraRunsAndStopsInTheMiddle) {
  WriteDataset(1);  // for the small rig's calib.yaml
  const std::string config = WriteConfig(
      "camera:\n  backend: simulated\n  timeout_ms: 30000\n"
      "  simulated: { meshes: " +
      std::filesystem::path(WIREPOSE_MESH).parent_path().string() +
      ", calibration: data/calib.yaml, frames: 0, samples_per_pixel: 4, truth_file: truth.jsonl }\n"
      "dds: { domain: " +
      domain_ + ", loopback: true }\nmodels: [parcel_box.wpm]\n");
  Process robot(folder_, "robot", Robot(config));
  Process watch(folder_, "watch", Watch({"--frames", "2", "--timeout", "60"}));
  ASSERT_EQ(watch.Wait(std::chrono::seconds(90)), 0) << watch.Err() << robot.Err();
  robot.Signal(SIGTERM);
  EXPECT_EQ(robot.Wait(), 0) << robot.Err();
  EXPECT_EQ(Messages(watch, "health").back()["camera"], "simulated");
  EXPECT_GT(std::filesystem::file_size(folder_ / "truth.jsonl"), 0u);
}

// systemd's protocol: datagrams of NAME=value lines on the socket named in NOTIFY_SOCKET.
TEST_F(WireposedTest, TellsSystemdReadyAliveAndStopping) {
  WriteDataset(2);
  const std::string path = (folder_ / "notify").string();
  const int notifications = socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(path.size(), sizeof address.sun_path);
  path.copy(address.sun_path, path.size());
  ASSERT_EQ(bind(notifications, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const timeval patience{2, 0};
  setsockopt(notifications, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);

  Process robot(folder_, "robot", Robot(LoopingConfig(), {"--frames", "20"}),
                {"NOTIFY_SOCKET=" + path, "WATCHDOG_USEC=400000"});
  ASSERT_EQ(robot.Wait(std::chrono::seconds(120)), 0) << robot.Err();
  std::vector<std::string> received;
  char text[1024];
  for (ssize_t size = 0; (size = recv(notifications, text, sizeof text, MSG_DONTWAIT)) > 0;) {
    received.emplace_back(text, static_cast<std::size_t>(size));
  }
  close(notifications);
  if (received.empty()) GTEST_SKIP() << "this build has no libsystemd";
  EXPECT_EQ(received.front().rfind("READY=1", 0), 0u) << received.front();
  EXPECT_EQ(received.back(), "STOPPING=1");
  // 20 frames at 25 Hz: 0.76 s, one sign of life each 0.1 s.
  const auto alive = std::count(received.begin(), received.end(), "WATCHDOG=1");
  EXPECT_GE(alive, 4);
  EXPECT_LE(alive, 9);
}

// --- What is refused
// ---------------------------------------------------------------------------------------------

class RefusalTest : public RobotTest {
 protected:
  // Expects one line on stderr that holds every text of `parts`, and the exit status.
  void Expect(const std::vector<std::string>& command, int status, const std::vector<std::string>& parts) const {
    Process robot(folder_, "robot", command);
    ASSERT_EQ(robot.Wait(), status) << robot.Err();
    const std::string err = robot.Err();
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    for (const std::string& part : parts) EXPECT_NE(err.find(part), std::string::npos) << err;
    EXPECT_EQ(robot.Out(), "");
  }
};

TEST_F(RefusalTest, CommandLine) {
  Expect({WIREPOSED_PROGRAM}, 2, {"--config"});
  Expect({WIREPOSED_PROGRAM, "--config", "x", "--fast"}, 2, {"--fast"});
  Expect(Robot("/no/such.yaml"), 2, {"/no/such.yaml", "no such file"});
  Expect(Robot(folder_.string()), 2, {folder_.string()});
}

TEST_F(RefusalTest, Configuration) {
  Expect(Robot(WriteConfig("camera:\n  backend: replay\n  zoom: 3\n")), 2,
         {"robot.yaml:3", "camera.zoom", "unknown key"});
  Expect(Robot(WriteConfig("camera: { backend: replay }\nmodels: [.]\n")), 2,
         {"robot.yaml", "camera.replay.data_set", "missing"});
  Expect(Robot(WriteConfig("camera: { backend: libcamera }\nmodels: [.]\n")), 2, {"robot.yaml", "libcamera"});
  const std::string good = LoopingConfig();
  Expect(Robot(good, {"--camera", "libcamera"}), 2, {"robot.yaml", "libcamera"});
  Expect(Robot(good, {"--camera", "polaroid"}), 2, {"polaroid", "replay"});
}

TEST_F(RefusalTest, CameraData) {
  const std::string config = LoopingConfig();
  Expect(Robot(config), 1, {"replay camera", "data"});
  WriteDataset(1);
  std::ofstream(folder_ / "data/calib.yaml") << "K1: nonsense\n";
  Expect(Robot(config), 1, {"calib.yaml"});
}

TEST_F(RefusalTest, Models) {
  WriteDataset(1);
  const std::string config = LoopingConfig();
  Expect(Robot(config, {"--models", "/no/such.wpm"}), 1, {"/no/such.wpm", "no such model"});
  const std::filesystem::path empty = folder_ / "empty";
  std::filesystem::create_directory(empty);
  Expect(Robot(config, {"--models", empty.string()}), 1, {"empty", "no .wpm file"});
  const std::string good = (folder_ / "parcel_box.wpm").string();
  Expect(Robot(config, {"--models", good, good}), 1, {"parcel_box.wpm", "same id"});
  std::vector<std::string> too_many(kMaxModels + 2, good);
  too_many[0] = "--models";
  Expect(Robot(config, too_many), 1, {"one model too many", "at most " + std::to_string(kMaxModels)});

  const std::filesystem::path bad = folder_ / "bad.wpm";
  std::ofstream(bad) << "not a model";
  Expect(Robot(config, {"--models", bad.string()}), 1, {"bad.wpm"});
  std::filesystem::copy_file(good, bad, std::filesystem::copy_options::overwrite_existing);
  std::fstream(bad, std::ios::in | std::ios::out | std::ios::binary).seekp(300).put('\x55');
  Expect(Robot(config, {"--models", bad.string()}), 1, {"bad.wpm"});
  std::filesystem::resize_file(bad, 1 << 22);
  Expect(Robot(config, {"--models", bad.string()}), 1, {"bad.wpm", "larger"});
}

TEST_F(RefusalTest, UnknownModelId) {
  WriteDataset(1);
  Expect(Robot(WriteConfig("camera: { backend: replay, replay: { data_set: data } }\n"
                           "models: [parcel_box.wpm]\nsearch_for: [1, 9]\n")),
         1, {"robot.yaml", "search_for", "9"});
}

TEST_F(RefusalTest, WatchWithoutARobot) {
  Expect(Watch({"--once", "--timeout", "0.5"}), 1, {"nothing arrived for 0.5 s", "domain " + domain_});
  Expect(Watch({"--topic", "weather"}), 2, {"weather"});
  Expect(Watch({"--domain", "500"}), 2, {"500"});
}

}  // namespace
}  // namespace wirepose::test
