// A secured wireposed, and who may listen to it and command it.
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "publish/security_settings.h"
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

  // Somebody on the bus: the folder that it takes its identity and permissions from, empty for none.
  struct Peer {
    std::string who, folder;
    bool patched = false;  // its own DDS permits everything (lax_access_control.cpp)
  };
  // What --security FOLDER sets, but for the plug-in.
  static std::string PatchedSettings(const std::string& folder) {
    const std::string settings =
        SecuritySettings({folder + "/identity_ca.pem", folder + "/certificate.pem", folder + "/key.pem",
                          folder + "/permissions_ca.pem", folder + "/governance.p7s", folder + "/permissions.p7s"});
    static const std::regex kPlugin(R"(path="[^"]*dds_security_ac[^"]*")");
    return std::regex_replace(settings, kPlugin, "path=\"" WIREPOSE_LAX_ACCESS_CONTROL "\"");
  }
  // `wirepose` with those arguments as that peer.
  std::unique_ptr<Process> As(const Peer& peer, const std::vector<std::string>& arguments) {
    std::vector<std::string> command = {WIREPOSE_PROGRAM};
    command.insert(command.end(), arguments.begin(), arguments.end());
    command.insert(command.end(), {"--json", "--domain", domain_, "--loopback"});
    std::vector<std::string> environment;
    if (peer.patched) {
      environment.push_back("CYCLONEDDS_URI=" + PatchedSettings(peer.folder));
    } else if (!peer.folder.empty()) {
      command.insert(command.end(), {"--security", peer.folder});
    }
    return std::make_unique<Process>(folder_, peer.who, command, environment);
  }
  std::unique_ptr<Process> Pause(const Peer& peer, const std::string& timeout_s) {
    return As(peer, {"command", "pause", "--timeout", timeout_s});
  }
  // Those who may not: nothing about them, another authority, no grant, permissions that another authority signed.
  // Whoever has the right identity is also there with its own DDS patched: then only the robot can refuse.
  std::vector<Peer> Unwelcome(const std::string& role) {
    Make({}, "rogue");
    Make({"stranger", "none"});
    std::filesystem::copy(Folder(role), Folder("forger"));
    for (const char* const file : {"/permissions.p7s", "/permissions_ca.pem", "/governance.p7s"}) {
      std::filesystem::copy_file(Folder(role, "rogue") + file, Folder("forger") + file,
                                 std::filesystem::copy_options::overwrite_existing);
    }
    return {{"nobody", ""},
            {"rogue", Folder(role, "rogue")},
            {"stranger", Folder("stranger")},
            {"patched_stranger", Folder("stranger"), true},
            {"forger", Folder("forger")}};
  }
  static void ExpectPatched(const Peer& peer, const Process& process) {
    EXPECT_EQ(process.Err().find("permits everything") != std::string::npos, peer.patched) << process.Err();
  }
  Json Health() {
    Process watch(folder_, "health", Watch({"--topic", "health", "--frames", "2", "--security", Folder("viewer")}));
    EXPECT_EQ(watch.Wait(), 0) << watch.Err() << robot_->Err();
    return watch.OutLines().empty() ? Json() : Json::parse(watch.OutLines().back());
  }

  std::unique_ptr<Process> robot_;
};

TEST_F(SecurityTest, OnlyTheGrantedHear) {
  const auto viewer = As({"viewer", Folder("viewer")}, {"watch", "--topic", "recognition", "--timeout", "0"});
  for (int i = 0; i < 2000 && viewer->Out().empty(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_FALSE(viewer->Out().empty()) << viewer->Err() << robot_->Err();

  const std::vector<Peer> unwelcome = Unwelcome("viewer");
  std::vector<std::unique_ptr<Process>> processes;
  for (const Peer& peer : unwelcome) {
    processes.push_back(As(peer, {"watch", "--topic", "recognition", "--once", "--timeout", "6"}));
  }
  std::this_thread::sleep_for(std::chrono::seconds(3));  // the viewer needed less
  const Json health = Health();
  ASSERT_TRUE(health.contains("events"));
  EXPECT_EQ(health["events"]["subscribers"], 2) << "matched: the viewer, and the one that asks for health now";
  for (std::size_t i = 0; i < processes.size(); ++i) {
    EXPECT_EQ(processes[i]->Wait(), 1) << unwelcome[i].who;
    EXPECT_EQ(processes[i]->Out(), "") << unwelcome[i].who << " got data";
    ExpectPatched(unwelcome[i], *processes[i]);
  }
  robot_->Signal(SIGTERM);
  EXPECT_EQ(robot_->Wait(), 0) << robot_->Err();
}

TEST_F(SecurityTest, OnlyTheOperatorCommands) {
  std::vector<Peer> unwelcome = Unwelcome("operator");
  unwelcome.push_back({"viewer", Folder("viewer")});
  unwelcome.push_back({"patched_viewer", Folder("viewer"), true});
  ASSERT_FALSE(Health().is_null());
  std::vector<std::unique_ptr<Process>> processes;
  for (const Peer& peer : unwelcome) processes.push_back(Pause(peer, "5"));
  for (std::size_t i = 0; i < processes.size(); ++i) {
    EXPECT_EQ(processes[i]->Wait(), 1) << unwelcome[i].who;
    ExpectPatched(unwelcome[i], *processes[i]);
  }
  Json health = Health();
  EXPECT_EQ(health["state"], "running") << "nobody may have paused it";
  EXPECT_EQ(health["events"]["commands_accepted"], 0);
  EXPECT_EQ(health["events"]["commands_refused"], 0);
  // The patch as such does no harm: who has the grant gets through with it, and without.
  for (const bool patched : {true, false}) {
    const auto operating = Pause({"operator", Folder("operator"), patched}, "20");
    EXPECT_EQ(operating->Wait(), 0) << operating->Err() << robot_->Err();
  }
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
