// The messages for people and tools: markers, diagnostics, commands.
#include <dds/ddsi/ddsi_cdrstream.h>
#include <gtest/gtest.h>

#include <memory>

#include "full_messages.h"
#include "publish/bus.h"
#include "publish/messages.h"

namespace wirepose {
namespace {

using test::RandomPose;

// --- Markers
// -------------------------------------------------------------------------------------------------------

class MarkersTest : public ::testing::Test {
 protected:
  [[nodiscard]] const visualization_msgs_msg_dds__Marker_& Marker(std::uint32_t i) const {
    return message_->value.markers._buffer[i];
  }
  // Three lines of the scene, and one object with two edges of which one has found a line.
  SceneReport OneObject() {
    SceneReport scene;
    for (int i = 0; i < 12; ++i) scene.points.push_back({static_cast<float>(i), 2, 3});
    SceneObject object;
    object.label = "book 0.93";
    object.T_camera_model = RandomPose(random_);
    object.wireframe = {0, 4};
    object.line_set = {4, 2};
    scene.objects.push_back(object);
    scene.lines = {6, 6};
    scene.stamp = std::chrono::milliseconds(1500);
    return scene;
  }

  std::mt19937 random_{4};
  std::unique_ptr<MarkersMessage> message_ = std::make_unique<MarkersMessage>();
};

TEST_F(MarkersTest, ShowObjectAndLines) {
  const SceneReport scene = OneObject();
  FillMessage(scene, "eye", *message_);
  ASSERT_EQ(message_->value.markers._length, 5u);
  EXPECT_EQ(Marker(0).action, 3) << "DELETEALL: what the frame before showed";
  const char* const names[] = {"", "lines", "wireframe", "line_set", "label"};
  for (std::uint32_t i = 1; i < 5; ++i) {
    EXPECT_STREQ(Marker(i).ns, names[i]);
    EXPECT_STREQ(Marker(i).header.frame_id, "eye");
    EXPECT_EQ(Marker(i).header.stamp.sec, 1);
    EXPECT_EQ(Marker(i).header.stamp.nanosec, 500'000'000u);
    EXPECT_EQ(Marker(i).action, 0) << "ADD";
    EXPECT_EQ(Marker(i).type, i == 4 ? 9 : 5) << "TEXT_VIEW_FACING, LINE_LIST";
    EXPECT_GT(Marker(i).color.a, 0);
  }
  EXPECT_EQ(Marker(1).points._length, 6u);
  EXPECT_EQ(Marker(1).points._buffer[0].x, 6);
  EXPECT_EQ(Marker(2).points._length, 4u);
  EXPECT_EQ(Marker(2).points._buffer[3].x, 3);
  EXPECT_EQ(Marker(3).points._length, 2u);
  EXPECT_EQ(Marker(3).points._buffer[0].x, 4);
  EXPECT_STREQ(Marker(4).text, "book 0.93");
  const Pose& T = scene.objects[0].T_camera_model;
  EXPECT_EQ(Marker(2).pose.position.x, T.t.x()) << "the wireframe is in the model's frame";
  EXPECT_EQ(Marker(3).pose.position.x, 0) << "the image lines are in the camera's";
  EXPECT_EQ(Marker(3).pose.orientation.w, 1);
  EXPECT_EQ(std::memcmp(&Marker(2).color, &Marker(3).color, sizeof Marker(2).color), 0)
      << "a set has its object's colour";
}

TEST_F(MarkersTest, EmptySceneClearsTheDisplay) {
  FillMessage(OneObject(), "eye", *message_);
  FillMessage(SceneReport{}, "eye", *message_);
  ASSERT_EQ(message_->value.markers._length, 1u);
  EXPECT_EQ(Marker(0).action, 3);
}

// --- Diagnostics
// ---------------------------------------------------------------------------------------------------

class DiagnosticsTest : public ::testing::Test {
 protected:
  // Level of the status of that name, as the report makes it.
  int Level(const HealthReport& report, std::string_view name) {
    FillMessage(report, losses_.Update(report), *message_);
    for (std::uint32_t i = 0; i < message_->value.status._length; ++i) {
      const auto& status = message_->value.status._buffer[i];
      text_ = status.message;
      if (std::string("wireposed: ").append(name) == status.name) return status.level;
    }
    return -1;
  }

  static HealthReport Good() {
    HealthReport report;
    report.state = HealthState::kRunning;
    report.camera_status = "ok";
    const ModelView models[] = {test::MakeModel(7, "juice_dispenser")};
    report.models = LabelsOf(models, 1);
    report.pool = {100, 200, 1000, 0, 0};
    return report;
  }

  LossMonitor losses_;
  std::unique_ptr<DiagnosticsMessage> message_ = std::make_unique<DiagnosticsMessage>();
  std::string text_;
};

TEST_F(DiagnosticsTest, AllIsWell) {
  for (const char* const name : {"camera", "recognition", "bus", "models"}) EXPECT_EQ(Level(Good(), name), 0) << name;
}

TEST_F(DiagnosticsTest, TroubleRaisesTheLevelAndSaysWhy) {
  HealthReport report = Good();
  report.state = HealthState::kBadFrames;
  report.camera_status = "image damaged";
  EXPECT_EQ(Level(report, "camera"), 1);
  EXPECT_EQ(text_, "image damaged");
  report.state = HealthState::kCameraLost;
  EXPECT_EQ(Level(report, "camera"), 2);
  report = Good();
  report.pool.used = 900;
  EXPECT_EQ(Level(report, "bus"), 1);
  EXPECT_NE(text_.find("pool"), std::string::npos);
  report = Good();
  report.rows = {RowState::kSteadyOffset, 20, 0.9F, 0.2F, 0.875F, 0.1F};
  EXPECT_EQ(Level(report, "camera"), 1);
  EXPECT_NE(text_.find("calibrate again"), std::string::npos) << text_;
  report.rows.state = RowState::kVaryingOffset;
  EXPECT_EQ(Level(report, "camera"), 1);
  EXPECT_NE(text_.find("not exposed together"), std::string::npos) << text_;
  report.state = HealthState::kCameraLost;
  report.camera_status = "camera disconnected";
  EXPECT_EQ(Level(report, "camera"), 2);
  EXPECT_EQ(text_, "camera disconnected") << "what is worse hides the rest";
  report = Good();
  report.rows = {RowState::kAligned, 20, 0.02F, 0.2F, 0.05F, 0.1F};
  EXPECT_EQ(Level(report, "camera"), 0);
  report = Good();
  report.models.clear();
  EXPECT_EQ(Level(report, "models"), 1);
}

// Who was warned is told when it is over; the counters stay.
TEST_F(DiagnosticsTest, LossesAreOverSomeTimeAfterTheLast) {
  HealthReport report = Good();
  std::uint64_t* const results = &report.results_dropped;
  std::uint64_t* const messages = &report.write_errors;
  for (std::uint64_t* const count : {results, messages}) {
    const auto level_at = [&](std::uint64_t seconds) {
      report.uptime_ns += seconds * 1'000'000'000;
      return Level(report, "bus");
    };
    EXPECT_EQ(level_at(1), 0);
    *count += 3;
    EXPECT_EQ(level_at(1), 1);
    EXPECT_NE(text_.find(count == results ? "dropped" : "refused"), std::string::npos) << text_;
    EXPECT_EQ(level_at(29), 1);
    EXPECT_EQ(level_at(1), 0) << "30 s after";
    *count += 1;
    EXPECT_EQ(level_at(1), 1) << "again";
    EXPECT_EQ(level_at(30), 0);
  }
  report.lists.detections.dropped = 1;
  EXPECT_EQ(Level(report, "recognition"), 1);
  report.uptime_ns += 30'000'000'000;
  EXPECT_EQ(Level(report, "recognition"), 0);
}

TEST_F(DiagnosticsTest, RowOffsetsAreValues) {
  HealthReport report = Good();
  report.rows = {RowState::kAligned, 17, 0.02F, 0.2F, 0.0625F, 0.125F};
  (void)Level(report, "camera");
  std::string values;
  for (std::uint32_t s = 0; s < message_->value.status._length; ++s) {
    const auto& list = message_->value.status._buffer[s].values;
    for (std::uint32_t i = 0; i < list._length; ++i) {
      values += std::string(list._buffer[i].key) + "=" + list._buffer[i].value + ";";
    }
  }
  for (const char* const value :
       {"row offset steady=0.06 px;", "row offset varying=0.12 px;", "row offset corners=17;"}) {
    EXPECT_NE(values.find(value), std::string::npos) << value << " is not in " << values;
  }
}

// --- Commands
// ------------------------------------------------------------------------------------------------------

TEST(CommandMessages, CarryEverything) {
  const auto in = std::make_unique<CommandMessage>();
  std::strcpy(in->value.sender, "planner");
  in->value.request_id = 77;
  in->value.action = wirepose_SELECT_MODELS;
  in->value.model_ids._buffer[0] = 3;
  in->value.model_ids._buffer[1] = 1;
  in->value.model_ids._length = 2;
  in->value.region = {10, 20, 30, 40};
  const Command command = ReadMessage(in->value);
  EXPECT_TRUE(command.sender == "planner");
  EXPECT_EQ(command.request_id, 77u);
  EXPECT_EQ(command.action, CommandAction::kSelectModels);
  ASSERT_EQ(command.model_ids.size(), 2u);
  EXPECT_EQ(command.model_ids[1], 1u);
  EXPECT_EQ(command.region, (ImageRegion{10, 20, 30, 40}));

  CommandAnswer answer;
  answer.command = command;
  answer.reason = "no such id";
  answer.paused = true;
  answer.searched_ids.push_back(9);
  answer.region = {1, 2, 3, 4};
  const auto out = std::make_unique<CommandStatusMessage>();
  FillMessage(answer, *out);
  EXPECT_STREQ(out->value.sender, "planner");
  EXPECT_EQ(out->value.request_id, 77u);
  EXPECT_EQ(out->value.action, wirepose_SELECT_MODELS);
  EXPECT_FALSE(out->value.accepted);
  EXPECT_STREQ(out->value.reason, "no such id");
  EXPECT_TRUE(out->value.paused);
  ASSERT_EQ(out->value.searched_ids._length, 1u);
  EXPECT_EQ(out->value.searched_ids._buffer[0], 9u);
  EXPECT_EQ(out->value.region.height_px, 4);
}

// --- Bounds
// --------------------------------------------------------------------------------------------------------

// Serialized with memory that grows; 4 bytes of header added.
std::uint32_t SerializedBytes(TopicId topic, const void* message) {
  dds_ostreamLE_t out;
  dds_ostreamLE_init(&out, 0, 1);
  dds_stream_writeLE(&out, static_cast<const char*>(message), Spec(topic).type->m_ops);
  const std::uint32_t bytes = out.x.m_index + 4;
  dds_ostreamLE_fini(&out);
  return bytes;
}

// For docs/dds.md: unambiguous objects, names of usual length.
TEST(MessageBounds, UsualSizes) {
  std::mt19937 random(8);
  const auto detections = std::make_unique<DetectionsMessage>();
  const auto recognition = std::make_unique<RecognitionMessage>();
  for (const std::size_t objects : {std::size_t{0}, std::size_t{2}, kMaxDetections}) {
    FrameReport frame = test::RandomReport(random, objects);
    for (Detection& detection : frame.result.detections) detection.modes.clear();
    FillMessage(frame, "wirepose_left_optical", *detections);
    FillMessage(frame, "wirepose_left_optical", *recognition);
    const std::uint32_t ros_bytes = SerializedBytes(TopicId::kDetections, &detections->value);
    const std::uint32_t native_bytes = SerializedBytes(TopicId::kRecognition, &recognition->value);
    std::printf("%zu objects: detections %u bytes, recognition %u bytes\n", objects, ros_bytes, native_bytes);
    EXPECT_LT(ros_bytes, 64 + 720 * objects);
    EXPECT_LT(native_bytes, 512 + 480 * objects);
  }
}

// The slots of the writers are as large as the largest message, and not much larger.
TEST(MessageBounds, FullMessagesFitTheirSlots) {
  std::mt19937 random(8);
  const auto detections = std::make_unique<DetectionsMessage>();
  const auto recognition = std::make_unique<RecognitionMessage>();
  const FrameReport frame = test::FullFrame(random);
  FillMessage(frame, test::LongText(), *detections);
  FillMessage(frame, test::LongText(), *recognition);
  recognition->value.lists._length = recognition->value.lists._maximum;
  const auto health = std::make_unique<HealthMessage>();
  const auto diagnostics = std::make_unique<DiagnosticsMessage>();
  FillMessage(test::FullHealth(), test::LongText(), *health);
  health->value.lists._length = health->value.lists._maximum;
  FillMessage(test::FullHealth(), {true, true, true}, *diagnostics);
  diagnostics->value.status._length = diagnostics->value.status._maximum;
  for (std::uint32_t i = 0; i < kDiagnosticStatuses; ++i) {
    auto& status = diagnostics->value.status._buffer[i];
    status.values._length = status.values._maximum;
    std::memset(status.name, 'x', sizeof status.name - 1);
    std::memset(status.message, 'x', sizeof status.message - 1);
    std::memset(status.hardware_id, 'x', sizeof status.hardware_id - 1);
    for (std::uint32_t v = 0; v < status.values._length; ++v) {
      std::memset(status.values._buffer[v].key, 'x', sizeof status.values._buffer[v].key - 1);
      std::memset(status.values._buffer[v].value, 'x', sizeof status.values._buffer[v].value - 1);
    }
  }
  const auto markers = std::make_unique<MarkersMessage>();
  FillMessage(test::FullScene(random), test::LongText(), *markers);
  ASSERT_EQ(markers->value.markers._length, markers->value.markers._maximum);
  const auto status = std::make_unique<CommandStatusMessage>();
  FillMessage(test::FullAnswer(), *status);

  const auto picture = std::make_unique<ImageReport>();
  const std::vector<std::uint8_t> pixels(kMaxPixels);
  FillImage({pixels.data(), kMaxImageWidth, kMaxImageHeight, kMaxImageWidth}, *picture);
  const auto image = std::make_unique<sensor_msgs_msg_dds__Image_>();
  FillMessage(*picture, test::LongText(), *image);
  std::memset(image->encoding, 'x', sizeof image->encoding - 1);

  const struct {
    TopicId topic;
    const void* message;
    std::uint32_t slot_bytes;
  } cases[] = {
      {TopicId::kDetections, &detections->value, kMaxDetectionsBytes},
      {TopicId::kRecognition, &recognition->value, kMaxRecognitionBytes},
      {TopicId::kHealth, &health->value, kMaxHealthBytes},
      {TopicId::kMarkers, &markers->value, kMaxMarkersBytes},
      {TopicId::kDiagnostics, &diagnostics->value, kMaxDiagnosticsBytes},
      {TopicId::kCommandStatus, &status->value, kMaxCommandStatusBytes},
      {TopicId::kImage, image.get(), kMaxImageBytes},
  };
  for (const auto& [topic, message, slot_bytes] : cases) {
    const std::uint32_t bytes = SerializedBytes(topic, message);
    std::printf("%s: %u bytes at most\n", Spec(topic).key, bytes);
    EXPECT_LE(bytes + 3, slot_bytes) << Spec(topic).key;
    EXPECT_GT(bytes, slot_bytes / 2) << Spec(topic).key << ": the slot wastes memory";
  }
}

}  // namespace
}  // namespace wirepose
