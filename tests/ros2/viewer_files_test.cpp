// The files for viewers in examples/ show what is published: topics, fields and frame are those of the interface.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "../publish/full_messages.h"
#include "../system/process.h"
#include "app/dds_config.h"
#include "message_json.h"
#include "publish/bus.h"

namespace wirepose::test {
namespace {

namespace fs = std::filesystem;
const fs::path kExamples = WIREPOSE_EXAMPLES;

// A topic as ROS names it; empty when it is none of ROS's.
std::string RosName(TopicId topic) {
  const std::string name = DefaultTopics()[static_cast<std::size_t>(topic)].name;
  return name.starts_with("rt/") ? name.substr(2) : "";
}

// A full message of each topic that the layout looks into.
std::map<std::string, Json> Messages() {
  std::mt19937 random(5);
  const auto detections = std::make_unique<DetectionsMessage>();
  FillMessage(FullFrame(random), "eye", *detections);
  const auto diagnostics = std::make_unique<DiagnosticsMessage>();
  FillMessage(FullHealth(), {}, *diagnostics);
  return {{RosName(TopicId::kDetections), RosJson(detections->value)},
          {RosName(TopicId::kDiagnostics), RosJson(diagnostics->value)},
          {RosName(TopicId::kMarkers), {}},
          {RosName(TopicId::kImage), {}}};
}

// Does Foxglove's path /topic.field[0].field lead to something?
bool Leads(const std::string& path, const std::map<std::string, Json>& messages) {
  const std::size_t end = path.find('.');
  const auto topic = messages.find(path.substr(0, end));
  if (topic == messages.end()) return false;
  const Json* at = &topic->second;
  const std::string fields = end == std::string::npos ? "" : path.substr(end);
  static const std::regex kField(R"(\.([a-z_]+)(\[(\d+)\])?)");
  std::size_t read = 0;
  for (std::sregex_iterator i(fields.begin(), fields.end(), kField), none; i != none; ++i) {
    const std::smatch& match = *i;
    read += static_cast<std::size_t>(match.length());
    if (!at->contains(match.str(1))) return false;
    at = &at->at(match.str(1));
    if (!match[3].matched) continue;
    const std::size_t index = std::stoul(match.str(3));
    if (!at->is_array() || index >= at->size()) return false;
    at = &at->at(index);
  }
  return read == fields.size();
}

// Everything in the layout that begins as a topic does, keys too.
void CollectPaths(const Json& json, std::set<std::string>& paths) {
  if (json.is_string() && json.get<std::string>().starts_with("/")) paths.insert(json.get<std::string>());
  if (!json.is_structured()) return;
  for (const auto& [key, value] : json.items()) {
    if (json.is_object() && key.starts_with("/")) paths.insert(key);
    CollectPaths(value, paths);
  }
}

void CollectPanels(const Json& layout, std::set<std::string>& panels) {
  if (layout.is_string()) {
    panels.insert(layout.get<std::string>());
    return;
  }
  CollectPanels(layout.at("first"), panels);
  CollectPanels(layout.at("second"), panels);
}

TEST(FoxgloveLayout, ShowsEveryRosTopicAndOnlyFieldsThatExist) {
  std::ifstream file(kExamples / "foxglove/wirepose.json");
  const Json layout = Json::parse(file);
  std::set<std::string> paths;
  CollectPaths(layout.at("configById"), paths);
  const std::map<std::string, Json> messages = Messages();
  for (const std::string& path : paths) EXPECT_TRUE(Leads(path, messages)) << path << " leads nowhere";
  for (const auto& [topic, message] : messages) {
    EXPECT_TRUE(std::any_of(paths.begin(), paths.end(), [&](const auto& path) { return path.starts_with(topic); }))
        << topic << " is not shown";
  }
  EXPECT_FALSE(Leads("/wirepose/detections.detections[0].no_such_field", messages)) << "the check sees nothing";

  std::set<std::string> placed;
  CollectPanels(layout.at("layout"), placed);
  std::set<std::string> configured;
  for (const auto& [panel, config] : layout.at("configById").items()) configured.insert(panel);
  EXPECT_EQ(placed, configured);
  EXPECT_EQ(layout.at("configById").at("3D!wirepose").at("followTf"), app::DdsConfig{}.frame_id);
}

TEST(LaunchFile, PlacesTheFrameOfThePosesAndOpensTheDisplay) {
  const fs::path folder = fs::temp_directory_path() / ("wirepose_launch_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const fs::path launch = kExamples / "ros2/wirepose.launch.py";
  Process python(folder, "launch", {WIREPOSE_PYTHON, WIREPOSE_LAUNCH_CHECK, launch.string()});
  ASSERT_EQ(python.Wait(), 0) << python.Err();
  std::map<std::string, std::vector<std::string>> nodes;
  for (const std::string& line : python.OutLines()) {
    const Json node = Json::parse(line);
    nodes[node.at("executable")] = node.at("arguments").get<std::vector<std::string>>();
  }
  fs::remove_all(folder);
  const auto argument = [&](const std::string& node, const std::string& name) -> std::string {
    const std::vector<std::string>& all = nodes.at(node);
    const auto at = std::find(all.begin(), all.end(), name);
    return at == all.end() || at + 1 == all.end() ? "" : *(at + 1);
  };
  ASSERT_EQ(nodes.size(), 2u);
  EXPECT_EQ(argument("static_transform_publisher", "--child-frame-id"), app::DdsConfig{}.frame_id);
  const std::string display = argument("rviz2", "-d");
  EXPECT_EQ(argument("rviz2", "-f"), argument("static_transform_publisher", "--frame-id"));

  const std::map<std::string, std::string> shown = {{"rviz_default_plugins/MarkerArray", RosName(TopicId::kMarkers)},
                                                    {"rviz_default_plugins/Image", RosName(TopicId::kImage)}};
  std::size_t found = 0;
  for (const YAML::Node& one : YAML::LoadFile(display)["Visualization Manager"]["Displays"]) {
    const auto wanted = shown.find(one["Class"].as<std::string>());
    if (wanted == shown.end()) continue;
    ++found;
    EXPECT_EQ(one["Topic"]["Value"].as<std::string>(), wanted->second);
    EXPECT_EQ(one["Topic"]["Durability Policy"].as<std::string>(), "Volatile") << "as it is offered";
  }
  EXPECT_EQ(found, shown.size());
}

}  // namespace
}  // namespace wirepose::test
