// What really goes over DDS: the bytes of the ROS 2 message, and each topic's way from the
// publisher to a reader.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <vector>

#include "../dds_domain.h"
#include "cdr_reader.h"
#include "publish/publisher.h"
#include "raw_bytes.h"
#include "reports_for_test.h"

namespace wirepose {
namespace {

using test::CdrReader;

// Publisher and reader in one process, on a domain of this process's own.
class WireTest : public ::testing::Test {
 protected:
  void SetUp() override {
    config_.bus.domain = domain_.id();
    config_.bus.loopback = true;
    config_.frame_id = "left_optical";
    config_.version = "9.8.7";
    const auto opened = publisher_->Open(config_);
    ASSERT_TRUE(opened) << opened.error();
    Result<Bus, std::string> bus = Bus::Open(config_.bus);
    ASSERT_TRUE(bus) << bus.error();
    bus_ = std::make_unique<Bus>(std::move(*bus));
  }
  void TearDown() override {
    bus_.reset();  // before the publisher, which owns the domain
    publisher_->Close();
  }

  dds_entity_t MatchedReader(TopicId topic) {
    const Result<dds_entity_t, std::string> reader = bus_->CreateReader(topic);
    if (!reader) throw std::runtime_error(reader.error());
    WaitUntil([&] {
      dds_subscription_matched_status_t status{};
      dds_get_subscription_matched_status(*reader, &status);
      return status.current_count > 0;
    });
    // The reader knows the writer; give the writer the same chance.
    dds_sleepfor(DDS_MSECS(200));
    return *reader;
  }

  static void WaitUntil(const std::function<bool()>& condition) {
    for (int i = 0; i < 1000; ++i) {
      if (condition()) return;
      dds_sleepfor(DDS_MSECS(10));
    }
    throw std::runtime_error("nothing happened for 10 s");
  }

  static void Take(dds_entity_t reader, void* message) {
    void* samples[] = {message};
    dds_sample_info_t info{};
    WaitUntil([&] { return dds_take(reader, samples, &info, 1, 1) == 1 && info.valid_data; });
  }

  static std::vector<unsigned char> TakeBytes(dds_entity_t reader) {
    std::vector<unsigned char> bytes;
    WaitUntil([&] {
      bytes = test::TakeRawBytes(reader);
      return !bytes.empty();
    });
    return bytes;
  }

  test::DdsDomain domain_;
  std::mt19937 random_{6};
  PublisherConfig config_;
  std::unique_ptr<Publisher> publisher_ = std::make_unique<Publisher>();
  std::unique_ptr<Bus> bus_;
};

void ExpectHeader(CdrReader& cdr, std::chrono::nanoseconds time) {
  const auto sec = cdr.Read<std::int32_t>();
  const auto nanosec = cdr.Read<std::uint32_t>();
  EXPECT_EQ(std::int64_t{sec} * 1'000'000'000 + nanosec, time.count());
  EXPECT_EQ(cdr.ReadString(), "left_optical");
}

void ExpectPose(CdrReader& cdr, const Matrix3d& R, const Vector3d& t, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(cdr.Read<double>(), t(i), tolerance);
  const double x = cdr.Read<double>();
  const double y = cdr.Read<double>();
  const double z = cdr.Read<double>();
  const double w = cdr.Read<double>();
  EXPECT_LT((Eigen::Quaterniond(w, x, y, z).toRotationMatrix() - R).norm(), 1e-12);
}

void ExpectResult(CdrReader& cdr, const Detection& in, const Pose& T, float weight) {
  EXPECT_EQ(cdr.ReadString(), "juice_dispenser");
  EXPECT_DOUBLE_EQ(cdr.Read<double>(), double{in.score} * double{weight});
  ExpectPose(cdr, T.R, T.t, 0);
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) {
      EXPECT_EQ(cdr.Read<double>(), in.covariance((r + 3) % 6, (c + 3) % 6));
    }
  }
}

void ExpectDetection(CdrReader& cdr, const FrameReport& report, const Detection& in) {
  ExpectHeader(cdr, report.stamp);
  const auto results = cdr.Read<std::uint32_t>();
  ASSERT_EQ(results, std::max<std::size_t>(1, in.modes.size()));
  for (std::uint32_t r = 0; r < results; ++r) {
    // Modes come with rising weight from RandomReport and go out with falling weight.
    if (in.modes.empty()) {
      ExpectResult(cdr, in, in.T_camera_model, 1);
    } else {
      const PoseMode& mode = in.modes[results - 1 - r];
      ExpectResult(cdr, in, mode.T_camera_model, mode.weight);
    }
  }
  ExpectPose(cdr, in.T_camera_model.R, in.T_camera_model * Vector3d(0.1, 0, 0.25), 1e-7);
  EXPECT_NEAR(cdr.Read<double>(), 0.4, 1e-7);
  EXPECT_NEAR(cdr.Read<double>(), 0.4, 1e-7);
  EXPECT_NEAR(cdr.Read<double>(), 0.5, 1e-7);
  EXPECT_EQ(cdr.ReadString(), in.track_id == 0 ? "" : std::to_string(in.track_id));
}

TEST_F(WireTest, RosMessageFieldByField) {
  const dds_entity_t reader = MatchedReader(TopicId::kDetections);
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{2}, kMaxDetections}) {
    const FrameReport report = test::RandomReport(random_, count);
    publisher_->Publish(report);
    const std::vector<unsigned char> bytes = TakeBytes(reader);
    CdrReader cdr(bytes);
    ExpectHeader(cdr, report.stamp);
    ASSERT_EQ(cdr.Read<std::uint32_t>(), count);
    for (const Detection& in : report.result.detections) ExpectDetection(cdr, report, in);
    EXPECT_TRUE(cdr.AtEnd());
  }
}

TEST_F(WireTest, TypeAndTopicAreThoseOfRos2) {
  const struct {
    TopicId topic;
    const char* name;
    const char* type;
  } expected[] = {
      {TopicId::kDetections, "rt/wirepose/detections", "vision_msgs::msg::dds_::Detection3DArray_"},
      {TopicId::kMarkers, "rt/wirepose/markers", "visualization_msgs::msg::dds_::MarkerArray_"},
      {TopicId::kDiagnostics, "rt/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_"},
      {TopicId::kImage, "rt/wirepose/left/image_raw", "sensor_msgs::msg::dds_::Image_"},
  };
  for (const auto& [topic, name, type] : expected) {
    EXPECT_STREQ(Spec(topic).name, name);
    EXPECT_STREQ(Spec(topic).type->m_typename, type);
    EXPECT_EQ(Spec(topic).type->m_nkeys, 0u);
  }
}

TEST_F(WireTest, RecognitionArrivesWhole) {
  const dds_entity_t reader = MatchedReader(TopicId::kRecognition);
  const FrameReport report = test::RandomReport(random_, kMaxDetections);
  publisher_->Publish(report);
  const auto sent = std::make_unique<RecognitionMessage>();
  FillMessage(report, config_.frame_id, *sent);
  const auto received = std::make_unique<RecognitionMessage>();
  Take(reader, &received->value);
  EXPECT_EQ(received->value.frame_sequence, report.sequence);
  ASSERT_EQ(received->value.detections._length, kMaxDetections);
  for (std::size_t i = 0; i < kMaxDetections; ++i) {
    const wirepose_Detection& a = sent->value.detections._buffer[i];
    const wirepose_Detection& b = received->value.detections._buffer[i];
    EXPECT_EQ(std::memcmp(&a.pose, &b.pose, sizeof a.pose), 0);
    EXPECT_EQ(std::memcmp(a.covariance, b.covariance, sizeof a.covariance), 0);
    ASSERT_EQ(a.modes._length, b.modes._length);
  }
  EXPECT_EQ(received->value.lists._length, kRecognitionLists.size());
}

TEST_F(WireTest, WhoComesLateGetsTheLastHealth) {
  HealthReport report;
  for (std::uint64_t i = 1; i <= 3; ++i) {
    report.uptime_ns = i;
    report.last_error = "frame 3: image damaged";
    report.rows = {RowState::kSteadyOffset, 20, -0.5F, 0.25F, 0.75F, 0.125F};
    const ModelView models[] = {test::MakeModel(7, "juice_dispenser")};
    report.models = LabelsOf(models, 1);
    publisher_->Publish(report);
    dds_sleepfor(DDS_MSECS(20));  // only the newest waits for the publisher
  }
  dds_sleepfor(DDS_MSECS(100));
  const dds_entity_t reader = MatchedReader(TopicId::kHealth);
  const auto received = std::make_unique<HealthMessage>();
  Take(reader, &received->value);
  EXPECT_EQ(received->value.uptime_ns, 3u);
  EXPECT_STREQ(received->value.version, "9.8.7");
  EXPECT_STREQ(received->value.last_error, "frame 3: image damaged");
  EXPECT_EQ(received->value.rows.state, wirepose_ROWS_STEADILY_OFF);
  EXPECT_EQ(received->value.rows.corners, 20u);
  EXPECT_EQ(received->value.rows.median_px, -0.5F);
  EXPECT_EQ(received->value.rows.spread_px, 0.25F);
  EXPECT_EQ(received->value.rows.steady_px, 0.75F);
  EXPECT_EQ(received->value.rows.varying_px, 0.125F);
  ASSERT_EQ(received->value.models._length, 1u);
  EXPECT_EQ(received->value.models._buffer[0].checksum, 0xC0FFEE07U);
}

TEST_F(WireTest, HealthAndDiagnosticsNameAsManyModelsAsThereCanBe) {
  const dds_entity_t health_reader = MatchedReader(TopicId::kHealth);
  const dds_entity_t diagnostics_reader = MatchedReader(TopicId::kDiagnostics);
  HealthReport report;
  report.models = test::AllLabels();
  publisher_->Publish(report);
  const auto health = std::make_unique<HealthMessage>();
  Take(health_reader, &health->value);
  ASSERT_EQ(health->value.models._length, kMaxModels);
  const auto diagnostics = std::make_unique<DiagnosticsMessage>();
  Take(diagnostics_reader, &diagnostics->value);
  const auto& values = diagnostics->value.status._buffer[3].values;
  ASSERT_EQ(values._length, kMaxModels);
  for (std::uint32_t i = 0; i < kMaxModels; ++i) {
    const bool searched = i == 0 || i == kMaxModels - 1;
    EXPECT_EQ(health->value.models._buffer[i].id, 100 + i);
    EXPECT_EQ(health->value.models._buffer[i].checksum, 0xC0FFEE00U + 100 + i);
    EXPECT_EQ(health->value.models._buffer[i].searched, searched) << i;
    const std::string value = values._buffer[i].value;
    EXPECT_EQ(value.rfind("id " + std::to_string(100 + i) + ",", 0), 0u) << value;
    EXPECT_EQ(value.find("not searched for") == std::string::npos, searched) << value;
  }
  EXPECT_EQ(publisher_->write_errors(), 0u);
}

TEST_F(WireTest, ACommandSelectsAsManyModelsAsThereCanBe) {
  const dds_entity_t answers = MatchedReader(TopicId::kCommandStatus);
  const Result<dds_entity_t, std::string> commands = bus_->CreateWriter(TopicId::kCommand);
  ASSERT_TRUE(commands) << commands.error();
  WaitUntil([&] {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(*commands, &status);
    return status.current_count > 0;
  });
  const auto sent = std::make_unique<CommandMessage>();
  sent->value.action = wirepose_SELECT_MODELS;
  auto& ids = sent->value.model_ids;
  std::iota(ids._buffer, ids._buffer + ids._maximum, 0x80000000U);
  ids._length = ids._maximum;
  ASSERT_EQ(dds_write(*commands, &sent->value), 0);
  Command command;
  WaitUntil([&] { return publisher_->TakeCommand(command); });
  ASSERT_EQ(command.model_ids.size(), kMaxModels);
  CommandAnswer answer;
  answer.command = command;
  answer.accepted = true;
  answer.searched_ids = command.model_ids;
  publisher_->Answer(answer);
  const auto received = std::make_unique<CommandStatusMessage>();
  Take(answers, &received->value);
  ASSERT_EQ(received->value.searched_ids._length, kMaxModels);
  EXPECT_TRUE(std::equal(ids._buffer, ids._buffer + kMaxModels, received->value.searched_ids._buffer));
}

// What is only for the eye is gathered and sent only while somebody subscribes to it; each frame asks again.
TEST_F(WireTest, MarkersAndImageAreWantedOnlyWhileSomebodyListens) {
  const auto becomes = [&](bool markers, bool image) {
    for (int i = 0; i < 500; ++i) {
      publisher_->Publish(FrameReport{});
      if (publisher_->SceneWanted() == markers && publisher_->ImageWanted() == image) return true;
      dds_sleepfor(DDS_MSECS(10));
    }
    return false;
  };
  publisher_->Publish(FrameReport{});
  dds_sleepfor(DDS_MSECS(50));
  EXPECT_FALSE(publisher_->SceneWanted() || publisher_->ImageWanted()) << "nobody is there";
  const dds_entity_t markers = MatchedReader(TopicId::kMarkers);
  EXPECT_TRUE(becomes(true, false));
  const dds_entity_t image = MatchedReader(TopicId::kImage);
  EXPECT_TRUE(becomes(true, true));
  dds_delete(markers);
  EXPECT_TRUE(becomes(false, true));
  dds_delete(image);
  EXPECT_TRUE(becomes(false, false));
}

// Who watches /diagnostics sees that losses have stopped; the uptime of the reports is what counts.
TEST_F(WireTest, DiagnosticsCalmDownAfterLosses) {
  const dds_entity_t reader = MatchedReader(TopicId::kDiagnostics);
  const auto received = std::make_unique<DiagnosticsMessage>();
  const auto bus_level_at = [&](std::uint64_t seconds, std::uint64_t dropped) -> int {
    HealthReport report;
    report.uptime_ns = seconds * 1'000'000'000;
    report.results_dropped = dropped;
    publisher_->Publish(report);
    Take(reader, &received->value);
    return received->value.status._buffer[2].level;
  };
  EXPECT_EQ(bus_level_at(5, 0), 0);
  EXPECT_STREQ(received->value.status._buffer[2].name, "wireposed: bus");
  EXPECT_EQ(bus_level_at(6, 4), 1);
  EXPECT_EQ(bus_level_at(35, 4), 1);
  EXPECT_EQ(bus_level_at(36, 4), 0);
  EXPECT_EQ(bus_level_at(37, 5), 1);
}

TEST_F(WireTest, ReportsArriveInOrder) {
  const dds_entity_t reader = MatchedReader(TopicId::kRecognition);
  for (std::uint64_t i = 1; i <= 3; ++i) {
    FrameReport report;
    report.sequence = i;
    publisher_->Publish(report);
  }
  const auto received = std::make_unique<RecognitionMessage>();
  for (std::uint64_t i = 1; i <= 3; ++i) {
    Take(reader, &received->value);
    EXPECT_EQ(received->value.frame_sequence, i);
  }
  EXPECT_EQ(publisher_->write_errors(), 0u);
}

TEST(Bus, DomainOutOfRangeIsRefusedWithAReason) {
  const Result<Bus, std::string> bus =
      Bus::Open({.domain = 5000, .loopback = true, .topics = DefaultTopics(), .security = {}});
  ASSERT_FALSE(bus);
  EXPECT_NE(bus.error().find("5000"), std::string::npos) << bus.error();
}

}  // namespace
}  // namespace wirepose
