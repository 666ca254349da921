// Two hosts and a bad network between them: network namespaces, joined by lossy_link.py.
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "robot_test_base.h"

namespace wirepose::test {
namespace {

using Json = nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

constexpr char kBusSettings[] =
    "CYCLONEDDS_URI=<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"wp0\" multicast=\"false\"/>"
    "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>3</MaxAutoParticipantIndex><Peers><Peer Address=\"10.77.0.1\"/>"
    "<Peer Address=\"10.77.0.2\"/></Peers></Discovery></Domain></CycloneDDS>";

class NetworkTest : public RobotTest {
 protected:
  void SetUp() override {
    RobotTest::SetUp();
    WriteDataset(3);
    link_ = std::make_unique<Process>(
        folder_, "link", std::vector<std::string>{"/usr/bin/env", "python3", WIREPOSE_LOSSY_LINK, Name(), "0.2", "50"});
    const bool there = WaitUntil([&] { return link_->Out() == "ready\n" || link_->Wait(seconds(0)); }, seconds(10));
    if (!there || link_->Out() != "ready\n") {
      GTEST_SKIP() << "no network namespaces and tunnels here (they need root): " << link_->Err();
    }
  }
  void TearDown() override {
    link_->Signal(SIGTERM);
    EXPECT_TRUE(link_->Wait(seconds(10)));
    RobotTest::TearDown();
  }

  static std::string Name() { return "wp" + std::to_string(getpid()); }
  std::unique_ptr<Process> On(const char* host, const std::string& name, const std::vector<std::string>& program) {
    std::vector<std::string> command = {"/usr/bin/env", "ip", "netns", "exec", Name() + "-" + host};
    command.insert(command.end(), program.begin(), program.end());
    return std::make_unique<Process>(folder_, name, command,
                                     std::vector<std::string>{kBusSettings, "WIREPOSE_TEST_NETWORK=1"});
  }
  static bool WaitUntil(const std::function<bool()>& condition, milliseconds limit) {
    for (const Clock::time_point end = Clock::now() + limit; Clock::now() < end;) {
      if (condition()) return true;
      std::this_thread::sleep_for(milliseconds(10));
    }
    return condition();
  }
  static int Count(const Process& subscriber) {
    const std::string out = subscriber.Out();
    const std::size_t last = out.rfind("count ");
    return last == std::string::npos ? 0 : std::stoi(out.substr(last + 6));
  }
  static Json LastLine(const Process& watch) {
    Json last;
    for (const std::string& line : watch.OutLines()) {
      Json message = Json::parse(line, nullptr, false);
      if (!message.is_discarded()) last = std::move(message);
    }
    return last;
  }

  std::unique_ptr<Process> link_;
};

// 20 % loss and 50 ms of delay, then nothing at all for longer than the lease.
TEST_F(NetworkTest, LongLossAndACutAreSurvived) {
  const std::string config = WriteConfig(
      "camera:\n  backend: replay\n  replay: { data_set: data, loop: true, frame_rate_hz: 25 }\n"
      "dds: { domain: " +
      domain_ + " }\nmodels: [parcel_box.wpm]\n");
  const auto robot = On("a", "robot", Robot(config));
  const auto health = On(
      "a", "health", {WIREPOSE_PROGRAM, "watch", "--json", "--topic", "health", "--domain", domain_, "--timeout", "0"});
  const auto subscriber = On("b", "subscriber", {WIREPOSE_TEST_SUBSCRIBER, domain_, "recognition"});
  ASSERT_TRUE(WaitUntil([&] { return Count(*subscriber) > 0; }, seconds(20))) << robot->Err() << subscriber->Err();
  ASSERT_TRUE(WaitUntil([&] { return !LastLine(*health).is_null(); }, seconds(20))) << health->Err();

  const int before_loss = Count(*subscriber);
  std::this_thread::sleep_for(seconds(6));
  const int through_loss = Count(*subscriber) - before_loss;
  EXPECT_GE(through_loss, 100) << "of 150 frames; a reliable reader gets most of those that are lost at first";

  const Json before = LastLine(*health);
  link_->Signal(SIGUSR1);
  std::this_thread::sleep_for(seconds(12));
  const int during_cut = Count(*subscriber);
  link_->Signal(SIGUSR2);
  const Clock::time_point mended = Clock::now();
  EXPECT_TRUE(WaitUntil([&] { return Count(*subscriber) > during_cut; }, seconds(30)));
  const double resumed_s = std::chrono::duration<double>(Clock::now() - mended).count();
  std::this_thread::sleep_for(seconds(2));
  const Json after = LastLine(*health);
  const auto pool_kib = [](const Json& message, const char* key) { return message["pool"][key].get<unsigned>() >> 10; };
  std::printf("%d of 150 frames through 20 %% loss; data again %.2f s after a cut of 12 s\n", through_loss, resumed_s);
  std::printf("pool: %u KiB before the cut, %u after, %u at most\n", pool_kib(before, "used_bytes"),
              pool_kib(after, "used_bytes"), pool_kib(after, "high_water_bytes"));
  EXPECT_LT(resumed_s, 2);
  EXPECT_LE(pool_kib(after, "used_bytes"), pool_kib(before, "used_bytes") + 40) << "the peer's second life costs more";

  const auto frames = [](const Json& message) { return message["frames"]["good"].get<int>(); };
  const double up_s = 1e-9 * (after["uptime_ns"].get<double>() - before["uptime_ns"].get<double>());
  EXPECT_GE(frames(after) - frames(before), static_cast<int>(0.95 * 25 * up_s)) << "the network held up vision";
  EXPECT_EQ(after["results_dropped"], before["results_dropped"]);
  EXPECT_EQ(after["write_errors"], 0);
  robot->Signal(SIGTERM);
  EXPECT_EQ(robot->Wait(), 0) << robot->Err();
}

// Its successor is found as soon as it is there; nothing waits for the lease of the dead.
TEST_F(RobotTest, KilledRobotProgramIsFoundAgainAfterItsRestart) {
  WriteDataset(3);
  const std::string config = LoopingConfig();
  auto robot = std::make_unique<Process>(folder_, "robot", Robot(config));
  Process subscriber(folder_, "subscriber", {WIREPOSE_TEST_SUBSCRIBER, domain_, "recognition"});
  const auto samples = [&] {
    int lines = 0;
    for (const std::string& line : subscriber.OutLines()) lines += line.rfind("count", 0) == 0 ? 1 : 0;
    return lines;
  };
  const auto wait_for_more = [&](seconds limit) {
    const int before = samples();
    for (const Clock::time_point end = Clock::now() + limit; Clock::now() < end;) {
      if (samples() > before + 1) return true;
      std::this_thread::sleep_for(milliseconds(20));
    }
    return false;
  };
  ASSERT_TRUE(wait_for_more(seconds(20))) << robot->Err();
  for (int i = 0; i < 2; ++i) {
    robot->Signal(SIGKILL);
    ASSERT_EQ(robot->Wait(), 128 + SIGKILL);
    robot = std::make_unique<Process>(folder_, "robot" + std::to_string(i), Robot(config));
    EXPECT_TRUE(wait_for_more(seconds(3))) << robot->Err();
  }
}

}  // namespace
}  // namespace wirepose::test
