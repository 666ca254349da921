// A secured wireposed, and who may listen to it and command it.
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "robot_test_base.h"

namespace wirepose::test {
namespace {

using Json = nlohmann::json;

class SecurityTest : public RobotTest {
 protected:
  void SetUp() override {
    RobotTest::SetUp();
    WriteDataset(3);
    Make({});
    robot_ = std::make_unique<Process>(folder_, "robot", Robot(Config()));
  }

  // scripts/make-security in the test's folder.
  void Make(const std::vector<std::string>& more, const std::string& authorities = "security") {
    std::vector<std::string> command = {WIREPOSE_MAKE_SECURITY, (folder_ / authorities).string()};
    command.insert(command.end(), more.begin(), more.end());
    Process process(folder_, "make", command);
    ASSERT_EQ(process.Wait(), 0) << process.Err();
  }
  std::string Config() {
    const std::string own = (folder_ / "security/wireposed/").string();
    return WriteConfig(
        "camera:\n  backend: replay\n  replay: { data_set: data, loop: true, frame_rate_hz: 25 }\n"
        "dds:\n  domain: " +
        domain_ + "\n  loopback: true\n  security:\n    identity_ca: " + own +
        "identity_ca.pem\n    certificate: " + own + "certificate.pem\n    private_key: " + own +
        "key.pem\n    permissions_ca: " + own + "permissions_ca.pem\n    governance: " + own +
        "governance.p7s\n    permissions: " + own + "permissions.p7s\nmodels: [parcel_box.wpm]\n");
  }
  [[nodiscard]] std::string Folder(const std::string& participant, const std::string& authorities = "security") const {
    return (folder_ / authorities / participant).string();
  }

  // A subscriber that ends with status 0 once it has data, and with 1 when there was none for that long.
  std::unique_ptr<Process> Subscribe(const std::string& name, const std::vector<std::string>& security,
                                     const std::string& timeout_s) {
    std::vector<std::string> arguments = {"--topic", "recognition", "--timeout", timeout_s};
    if (timeout_s != "0") arguments.emplace_back("--once");
    arguments.insert(arguments.end(), security.begin(), security.end());
    return std::make_unique<Process>(folder_, name, Watch(arguments));
  }
  // Status of `wirepose command pause`.
  int Pause(const std::vector<std::string>& security, const std::string& timeout_s) {
    std::vector<std::string> command = {WIREPOSE_PROGRAM, "command",    "pause",     "--json", "--domain",
                                        domain_,          "--loopback", "--timeout", timeout_s};
    command.insert(command.end(), security.begin(), security.end());
    Process process(folder_, "command", command);
    return process.Wait().value_or(-1);
  }
  Json Health() {
    Process watch(folder_, "health", Watch({"--topic", "health", "--frames", "2", "--security", Folder("viewer")}));
    EXPECT_EQ(watch.Wait(), 0) << watch.Err() << robot_->Err();
    return watch.OutLines().empty() ? Json() : Json::parse(watch.OutLines().back());
  }

  std::unique_ptr<Process> robot_;
};

TEST_F(SecurityTest, OnlyTheGrantedHearAndOnlyOperatorsCommand) {
  // Those who may: one that stays.
  const auto viewer = Subscribe("viewer", {"--security", Folder("viewer")}, "0");
  const auto has_data = [&] { return !viewer->Out().empty(); };
  for (int i = 0; i < 2000 && !has_data(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_TRUE(has_data()) << viewer->Err() << robot_->Err();

  // Those who may not: nothing about them, another authority, no grant, permissions that somebody else signed.
  Make({}, "rogue");
  Make({"stranger", "none"});
  std::filesystem::copy(Folder("viewer"), Folder("forger"));
  std::filesystem::copy_file(Folder("viewer", "rogue") + "/permissions.p7s", Folder("forger") + "/permissions.p7s",
                             std::filesystem::copy_options::overwrite_existing);
  const std::vector<std::vector<std::string>> unwelcome = {{},
                                                           {"--security", Folder("viewer", "rogue")},
                                                           {"--security", Folder("stranger")},
                                                           {"--security", Folder("forger")}};
  std::vector<std::unique_ptr<Process>> subscribers;
  for (const auto& security : unwelcome) {
    subscribers.push_back(Subscribe("unwelcome" + std::to_string(subscribers.size()), security, "6"));
  }
  std::this_thread::sleep_for(std::chrono::seconds(3));  // the viewer needed less
  Json health = Health();
  ASSERT_TRUE(health.contains("events"));
  EXPECT_EQ(health["events"]["subscribers"], 2) << "matched: the viewer, and the one that asks for health now";
  for (std::size_t i = 0; i < subscribers.size(); ++i) {
    EXPECT_EQ(subscribers[i]->Wait(), 1) << i << ": " << subscribers[i]->Err();
    EXPECT_EQ(subscribers[i]->Out(), "") << i << " got data";
  }

  // Commands.
  for (const auto& security : {std::vector<std::string>{},
                               {"--security", Folder("viewer")},
                               {"--security", Folder("operator", "rogue")},
                               {"--security", Folder("stranger")}}) {
    EXPECT_EQ(Pause(security, "3"), 1) << (security.empty() ? "no security" : security[1]);
  }
  health = Health();
  EXPECT_EQ(health["state"], "running") << "nobody may have paused it";
  EXPECT_EQ(health["events"]["commands_accepted"], 0);
  EXPECT_EQ(health["events"]["commands_refused"], 0);
  EXPECT_EQ(Pause({"--security", Folder("operator")}, "20"), 0) << robot_->Err();
  health = Health();
  EXPECT_EQ(health["state"], "paused");
  std::printf("pool: %u of %u KiB at most\n", health["pool"]["high_water_bytes"].get<unsigned>() >> 10,
              health["pool"]["capacity_bytes"].get<unsigned>() >> 10);
  EXPECT_LT(health["pool"]["high_water_bytes"], health["pool"]["capacity_bytes"]);
  robot_->Signal(SIGTERM);
  EXPECT_EQ(robot_->Wait(), 0) << robot_->Err();
}

}  // namespace
}  // namespace wirepose::test
