// Commands to a running wireposed, sent by `wirepose command` in another process.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/command_handler.h"
#include "robot_test_base.h"

namespace wirepose::test {
namespace {

using Json = nlohmann::json;

class CommandTest : public RobotTest {
 protected:
  void SetUp() override {
    RobotTest::SetUp();
    WriteDataset(3);
    std::filesystem::create_directory(folder_ / "models");
    std::filesystem::rename(folder_ / "parcel_box.wpm", folder_ / "models/parcel_box.wpm");
    config_ = WriteConfig(
        "camera:\n  backend: replay\n  timeout_ms: 200\n  replay: { data_set: data, loop: true, frame_rate_hz: 25 }\n"
        "dds: { domain: " +
        domain_ + ", loopback: true }\nmodels: [models]\n");
    robot_ = std::make_unique<Process>(folder_, "robot", Robot(config_));
  }
  void TearDown() override {
    EXPECT_EQ(robot_->Wait(std::chrono::seconds(0)), std::nullopt) << "died: " << robot_->Err();
    robot_.reset();
    RobotTest::TearDown();
  }

  // The answer; null when none came.
  Json Ask(const std::vector<std::string>& what) {
    std::vector<std::string> command = {WIREPOSE_PROGRAM, "command", "--json", "--domain", domain_, "--loopback"};
    command.insert(command.end(), what.begin(), what.end());
    Process process(folder_, "command", command);
    status_ = process.Wait().value_or(-1);
    err_ = process.Err();
    return process.OutLines().empty() ? Json() : Json::parse(process.OutLines()[0]);
  }
  Json LastHealth() {
    Process watch(folder_, "health", Watch({"--topic", "health", "--frames", "2"}));
    EXPECT_EQ(watch.Wait(), 0) << watch.Err();
    return Json::parse(watch.OutLines().back());
  }
  void BuildModel(const std::string& name, int id) {
    Process build(folder_, "build",
                  {WIREPOSE_PROGRAM, "model", "build", WIREPOSE_MESH, "--id", std::to_string(id), "--name", name, "--out",
                   (folder_ / "models" / (name + ".wpm")).string()});
    ASSERT_EQ(build.Wait(), 0) << build.Err();
  }

  std::string config_;
  std::unique_ptr<Process> robot_;
  int status_ = 0;
  std::string err_;
};

TEST_F(CommandTest, PauseStopsRecognitionAndResumeGoesOn) {
  Json answer = Ask({"pause"});
  ASSERT_EQ(status_, 0) << err_;
  EXPECT_EQ(answer["accepted"], true);
  EXPECT_EQ(answer["paused"], true);
  EXPECT_EQ(LastHealth()["state"], "paused");
  Process silent(folder_, "silent", Watch({"--topic", "recognition", "--once", "--timeout", "1"}));
  EXPECT_EQ(silent.Wait(), 1) << "nothing is recognized while paused";
  answer = Ask({"resume"});
  EXPECT_EQ(answer["paused"], false);
  Process lively(folder_, "lively", Watch({"--topic", "recognition", "--frames", "3"}));
  EXPECT_EQ(lively.Wait(), 0) << lively.Err();
}

TEST_F(CommandTest, SelectionAndRegionHoldUntilChanged) {
  EXPECT_EQ(Ask({"select", "1"})["searched_ids"], Json::array({1}));
  Json answer = Ask({"region", "10", "20", "100", "80"});
  EXPECT_EQ(answer["accepted"], true);
  EXPECT_EQ(answer["region"]["width_px"], 100);
  answer = Ask({"select"});
  EXPECT_EQ(answer["searched_ids"], Json::array({1})) << "no ids: all that are loaded";
  EXPECT_EQ(answer["region"]["width_px"], 100);
  EXPECT_EQ(Ask({"region"})["region"]["width_px"], 0) << "no numbers: the whole image";
}

TEST_F(CommandTest, RefusalsHaveReasonsAndChangeNothing) {
  const struct {
    std::vector<std::string> command;
    const char* reason;
  } cases[] = {{{"select", "1", "9"}, "no model file has the id 9"},
               {{"region", "100", "0", "100", "100"}, "beyond the image of 160x120"},
               {{"region", "0", "0", "10", "100"}, "smaller than 16x16"},
               {{"region", "5", "5", "0", "0"}, "smaller than 16x16"}};
  for (const auto& [command, reason] : cases) {
    const Json answer = Ask(command);
    EXPECT_EQ(status_, 1);
    EXPECT_EQ(answer["accepted"], false);
    EXPECT_NE(answer["reason"].get<std::string>().find(reason), std::string::npos) << answer;
    EXPECT_NE(err_.find(reason), std::string::npos) << err_;
    EXPECT_EQ(answer["searched_ids"], Json::array({1}));
    EXPECT_EQ(answer["region"]["width_px"], 0);
    EXPECT_EQ(answer["paused"], false);
  }
  const Json health = LastHealth();
  EXPECT_EQ(health["events"]["commands_refused"], 4);
  EXPECT_EQ(health["events"]["commands_accepted"], 0);
}

TEST_F(CommandTest, ReloadTakesNewModelsAndRefusesBadOnes) {
  BuildModel("second", 2);
  EXPECT_EQ(Ask({"reload"})["searched_ids"], Json::array({1, 2}));
  EXPECT_EQ(Ask({"select", "2"})["searched_ids"], Json::array({2}));

  std::ofstream(folder_ / "models/bad.wpm") << "not a model";
  Json answer = Ask({"reload"});
  EXPECT_EQ(answer["accepted"], false);
  EXPECT_NE(answer["reason"].get<std::string>().find("bad.wpm"), std::string::npos) << answer;
  EXPECT_EQ(answer["searched_ids"], Json::array({2}));
  std::filesystem::remove(folder_ / "models/bad.wpm");

  BuildModel("twin", 1);
  answer = Ask({"reload"});
  EXPECT_EQ(answer["accepted"], false);
  EXPECT_NE(answer["reason"].get<std::string>().find("same id"), std::string::npos) << answer;
  std::filesystem::remove(folder_ / "models/twin.wpm");

  std::filesystem::remove(folder_ / "models/second.wpm");
  answer = Ask({"reload"});
  EXPECT_EQ(answer["accepted"], false) << "nothing would be left to search for: " << answer;
  EXPECT_EQ(Ask({"select", "1"})["accepted"], true);
  EXPECT_EQ(Ask({"reload"})["searched_ids"], Json::array({1}));
  EXPECT_EQ(LastHealth()["models"].size(), 1u);
}

TEST_F(CommandTest, NamesOfTopicsComeFromTheConfiguration) {
  const std::string config = WriteConfig(
      "camera:\n  backend: replay\n  replay: { data_set: data, loop: true, frame_rate_hz: 25 }\n"
      "dds:\n  domain: " +
      domain_ +
      "\n  loopback: true\n  frame_id: eye\n  stamp: capture\n  topics:\n"
      "    detections: { name: rt/robot1/objects, reliable: false, depth: 1 }\n"
      "    recognition: { name: robot1/recognition, deadline_ms: 500 }\nmodels: [models]\n");
  Process other(folder_, "other", Robot(config));
  Process detections(folder_, "detections",
                     Watch({"--topic", "detections", "--once", "--name", "detections=rt/robot1/objects", "--best-effort"}));
  EXPECT_EQ(detections.Wait(), 0) << detections.Err();
  EXPECT_EQ(Json::parse(detections.OutLines()[0])["header"]["frame_id"], "eye");
  Process recognition(folder_, "recognition",
                      Watch({"--topic", "recognition", "--once", "--name", "recognition=robot1/recognition"}));
  EXPECT_EQ(recognition.Wait(), 0) << recognition.Err();
  const Json message = Json::parse(recognition.OutLines()[0]);
  EXPECT_EQ(message["stamp_ns"], message["capture_time_ns"]);
  Process reliable(folder_, "reliable", Watch({"--topic", "detections", "--once", "--timeout", "1.5", "--name",
                                               "detections=rt/robot1/objects"}));
  EXPECT_EQ(reliable.Wait(), 1);
  EXPECT_NE(reliable.Err().find("--best-effort"), std::string::npos) << reliable.Err();
}

// An action that no version of ours knows, as another program may send it.
TEST(CommandHandler, UnknownActionsAreRefused) {
  static Recognizer recognizer;
  static app::ModelLibrary models(recognizer);
  app::CommandHandler handler(recognizer, models, 640, 480);
  for (const int action : {0, 6, 255}) {
    Command command;
    command.action = static_cast<CommandAction>(action);
    command.request_id = 5;
    const CommandAnswer answer = handler.Execute(command);
    EXPECT_FALSE(answer.accepted);
    EXPECT_NE(std::string(std::string_view(answer.reason)).find("no action " + std::to_string(action)), std::string::npos);
    EXPECT_EQ(answer.command.request_id, 5u);
  }
  EXPECT_FALSE(handler.paused());
}

}  // namespace
}  // namespace wirepose::test
