// What goes over DDS, read by a ROS 2 decoder that is not ours: every field of every rt/ topic.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <map>

#include "../dds_domain.h"
#include "../publish/full_messages.h"
#include "../publish/raw_bytes.h"
#include "message_json.h"
#include "node.h"
#include "publish/publisher.h"

namespace wirepose::test {
namespace {

class RosDecodeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!NodeIsThere()) GTEST_SKIP() << "node or its packages are not to be had here; see the test npm_packages";
    folder_ = std::filesystem::temp_directory_path() / ("wirepose_ros_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    config_.bus.domain = domain_.id();
    config_.bus.loopback = true;
    config_.frame_id = "left_optical";
    config_.version = "1";
    const auto opened = publisher_->Open(config_);
    ASSERT_TRUE(opened) << opened.error();
    Result<Bus, std::string> bus = Bus::Open(config_.bus);
    ASSERT_TRUE(bus) << bus.error();
    bus_ = std::make_unique<Bus>(std::move(*bus));
  }
  void TearDown() override {
    bus_.reset();  // before the publisher, which owns the domain
    publisher_->Close();
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }

  dds_entity_t Reader(TopicId topic) {
    const auto reader = bus_->CreateReader(topic);
    if (!reader) throw std::runtime_error(reader.error());
    dds_sleepfor(DDS_MSECS(300));  // until both sides know each other
    return *reader;
  }

  // Publishes a report, takes the bytes that arrive and writes them beside what was meant.
  template <typename Report>
  void Save(const Report& report, dds_entity_t reader, const char* type, const Json& meant) {
    publisher_->Publish(report);
    std::vector<unsigned char> bytes;
    for (int i = 0; i < 500 && bytes.empty(); ++i) {
      dds_sleepfor(DDS_MSECS(5));
      bytes = TakeRawBytes(reader);
    }
    ASSERT_FALSE(bytes.empty()) << type << " did not arrive";
    const std::string name = (folder_ / std::to_string(saved_++)).string();
    std::ofstream(name + ".cdr", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    std::ofstream(name + ".json") << Json{{"type", type}, {"message", meant}};
  }

  void Decode() {
    Process node(folder_, "node", NodeCommand("decode.mjs", {folder_.string()}));
    EXPECT_EQ(node.Wait(), 0) << node.Err();
    EXPECT_EQ(node.Out(), std::to_string(saved_) + " messages decoded and encoded again, 0 differences\n");
  }

  DdsDomain domain_;
  std::mt19937 random_{9};
  PublisherConfig config_;
  std::unique_ptr<Publisher> publisher_ = std::make_unique<Publisher>();
  std::unique_ptr<Bus> bus_;
  std::filesystem::path folder_;
  int saved_ = 0;
};

TEST_F(RosDecodeTest, Detections) {
  const dds_entity_t reader = Reader(TopicId::kDetections);
  const auto message = std::make_unique<DetectionsMessage>();
  const auto save = [&](const FrameReport& report) {
    FillMessage(report, config_.frame_id, *message);
    Save(report, reader, "vision_msgs/Detection3DArray", RosJson(message->value));
  };
  for (std::size_t objects = 0; objects <= kMaxDetections; ++objects) save(RandomReport(random_, objects));
  save(FullFrame(random_));
  Decode();
}

TEST_F(RosDecodeTest, Markers) {
  const dds_entity_t reader = Reader(TopicId::kMarkers);
  const auto message = std::make_unique<MarkersMessage>();
  for (const SceneReport& scene : {SceneReport{}, FullScene(random_)}) {
    FillMessage(scene, config_.frame_id, *message);
    Save(scene, reader, "visualization_msgs/MarkerArray", RosJson(message->value));
  }
  Decode();
}

TEST_F(RosDecodeTest, Diagnostics) {
  const dds_entity_t reader = Reader(TopicId::kDiagnostics);
  const auto message = std::make_unique<DiagnosticsMessage>();
  for (HealthReport report : {HealthReport{}, FullHealth()}) {
    // What the publisher fills in, as it stands now: one subscriber.
    report.events.subscribers = 1;
    FillMessage(report, LossMonitor().Update(report), *message);
    Save(report, reader, "diagnostic_msgs/DiagnosticArray", RosJson(message->value));
  }
  Decode();
}

TEST_F(RosDecodeTest, Image) {
  const dds_entity_t reader = Reader(TopicId::kImage);
  const auto image = std::make_unique<ImageReport>();
  const auto message = std::make_unique<sensor_msgs_msg_dds__Image_>();
  for (const auto& [width, height] : {std::pair{640, 480}, std::pair{65, 64}}) {
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(700 * height));
    for (std::uint8_t& pixel : pixels) pixel = static_cast<std::uint8_t>(random_());
    image->stamp = std::chrono::milliseconds(1500);
    FillImage({pixels.data(), width, height, 700}, *image);
    EXPECT_EQ(image->pixels[static_cast<std::size_t>(width)], pixels[700]) << "rows follow each other";
    FillMessage(*image, config_.frame_id, *message);
    Save(*image, reader, "sensor_msgs/Image", RosJson(*message));
  }
  Decode();
}

// ROS 2 from Iron on asks for the hash of the type, and warns where it is missing. The script checks itself on hashes
// that ROS 2 generated, then computes ours from the official definitions.
TEST_F(RosDecodeTest, TypeHashesAreThoseOfTheOfficialDefinitions) {
  Process node(folder_, "node", NodeCommand("type_hash.mjs", {}));
  ASSERT_EQ(node.Wait(), 0) << node.Err();
  const std::map<std::string, TopicId> topics = {{"vision_msgs/Detection3DArray", TopicId::kDetections},
                                                 {"visualization_msgs/MarkerArray", TopicId::kMarkers},
                                                 {"diagnostic_msgs/DiagnosticArray", TopicId::kDiagnostics},
                                                 {"sensor_msgs/Image", TopicId::kImage}};
  std::map<std::string, std::string> hashes;
  for (const std::string& line : node.OutLines()) {
    const std::size_t blank = line.find(' ');
    hashes[line.substr(0, blank)] = line.substr(blank + 1);
  }
  ASSERT_EQ(hashes.size(), topics.size());
  for (const auto& [type, topic] : topics) EXPECT_EQ(Spec(topic).ros_hash, hashes.at(type)) << type;
}

// What a subscriber sees of our writer during discovery.
TEST_F(RosDecodeTest, TypeHashTravelsAsUserData) {
  const dds_entity_t reader = Reader(TopicId::kDetections);
  dds_instance_handle_t writer = 0;
  ASSERT_EQ(dds_get_matched_publications(reader, &writer, 1), 1);
  dds_builtintopic_endpoint_t* const endpoint = dds_get_matched_publication_data(reader, writer);
  ASSERT_NE(endpoint, nullptr);
  EXPECT_STREQ(endpoint->type_name, "vision_msgs::msg::dds_::Detection3DArray_");
  void* bytes = nullptr;
  std::size_t size = 0;
  ASSERT_TRUE(dds_qget_userdata(endpoint->qos, &bytes, &size));
  EXPECT_EQ(std::string(static_cast<const char*>(bytes), size),
            std::string("typehash=") + Spec(TopicId::kDetections).ros_hash + ";");
  dds_free(bytes);
  dds_builtintopic_free_endpoint(endpoint);
}

}  // namespace
}  // namespace wirepose::test
