#include "publish/messages.h"

#include <gtest/gtest.h>

#include <memory>

#include "reports_for_test.h"

namespace wirepose {
namespace {

using test::RandomCovariance;
using test::RandomPose;
using test::RandomReport;
using test::RandomRotation;

// --- Quaternion
// --------------------------------------------------------------------------------------------------

// Turns v by the textbook sandwich product, written out from the definition q v q*.
Vector3d Turn(const std::array<double, 4>& q, const Vector3d& v) {
  const Vector3d u(q[0], q[1], q[2]);
  const Vector3d t = 2 * u.cross(v);
  return v + q[3] * t + u.cross(t);
}

TEST(QuaternionOf, IsUnitAndTurnsAsTheMatrixDoes) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Matrix3d R = RandomRotation(random);
    const std::array<double, 4> q = QuaternionOf(R);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-14);
    EXPECT_GE(q[3], 0);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LT((Turn(q, Vector3d::Unit(axis)) - R.col(axis)).norm(), 1e-13);
    }
  }
}

TEST(QuaternionOf, IdentityHasNoNegativeZero) {
  const std::array<double, 4> q = QuaternionOf(Matrix3d::Identity());
  EXPECT_EQ(q, (std::array<double, 4>{0, 0, 0, 1}));
  for (const double component : q) EXPECT_FALSE(std::signbit(component));
}

TEST(QuaternionOf, HalfTurnsAreCanonical) {
  for (int axis = 0; axis < 3; ++axis) {
    Matrix3d R = -Matrix3d::Identity();
    R(axis, axis) = 1;
    const std::array<double, 4> q = QuaternionOf(R);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(q[static_cast<std::size_t>(i)], i == axis ? 1 : 0);
    EXPECT_EQ(q[3], 0);
  }
}

TEST(QuaternionOf, MatrixThatIsSlightlyOffGivesAUnitQuaternion) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> error(-1e-4, 1e-4);
  for (int i = 0; i < 200; ++i) {
    Matrix3d R = RandomRotation(random);
    for (Eigen::Index k = 0; k < 9; ++k) R(k) += error(random);
    const std::array<double, 4> q = QuaternionOf(R);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-14);
  }
}

// --- Covariance
// --------------------------------------------------------------------------------------------------

// The oracle is sampling: poses are perturbed as Detection::covariance says, then ROS's six numbers
// are measured on them (position of the model origin; rotation about the camera's fixed axes) and
// their covariance is compared.
TEST(RosCovariance, MatchesTheSpreadOfSampledPoses) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Matrix6d covariance = RandomCovariance(random);
  const Matrix6d L = covariance.llt().matrixL();
  const Pose T = RandomPose(random);
  Matrix6d sampled = Matrix6d::Zero();
  constexpr int kSamples = 200000;
  for (int i = 0; i < kSamples; ++i) {
    Vector6d white;
    for (Eigen::Index k = 0; k < 6; ++k) white(k) = normal(random);
    const Pose moved = PerturbLeft(T, L * white, T.t);
    const Matrix3d dR = moved.R * T.R.transpose();
    Vector6d ros;
    ros << moved.t - T.t, 0.5 * Vector3d(dR(2, 1) - dR(1, 2), dR(0, 2) - dR(2, 0), dR(1, 0) - dR(0, 1));
    sampled += ros * ros.transpose() / kSamples;
  }
  const std::array<double, 36> converted = RosCovariance(covariance);
  for (Eigen::Index r = 0; r < 6; ++r) {
    for (Eigen::Index c = 0; c < 6; ++c) {
      const double scale = std::sqrt(sampled(r, r) * sampled(c, c));
      EXPECT_NEAR(converted[static_cast<std::size_t>(6 * r + c)], sampled(r, c), 0.02 * scale);
    }
  }
}

TEST(RosCovariance, PutsTranslationFirst) {
  Matrix6d covariance;
  for (Eigen::Index r = 0; r < 6; ++r) {
    for (Eigen::Index c = 0; c < 6; ++c) covariance(r, c) = static_cast<double>(10 * r + c);
  }
  const std::array<double, 36> ros = RosCovariance(covariance);
  EXPECT_EQ(ros[0], 33);   // x x
  EXPECT_EQ(ros[2], 35);   // x z
  EXPECT_EQ(ros[3], 30);   // x rx
  EXPECT_EQ(ros[18], 3);   // rx x
  EXPECT_EQ(ros[35], 22);  // rz rz
}

// --- Messages
// ----------------------------------------------------------------------------------------------------

class MessagesTest : public ::testing::Test {
 protected:
  std::mt19937 random_{4};
  std::unique_ptr<DetectionsMessage> detections_ = std::make_unique<DetectionsMessage>();
  std::unique_ptr<RecognitionMessage> recognition_ = std::make_unique<RecognitionMessage>();
};

TEST_F(MessagesTest, NothingFoundIsAnEmptyList) {
  FillMessage(RandomReport(random_, 3), "camera", *detections_);
  FillMessage(RandomReport(random_, 0), "camera", *detections_);
  EXPECT_EQ(detections_->value.detections._length, 0u);
  FillMessage(RandomReport(random_, 0), "camera", *recognition_);
  EXPECT_EQ(recognition_->value.detections._length, 0u);
}

TEST_F(MessagesTest, RosMessageNamesAndPlacesEveryDetection) {
  const FrameReport report = RandomReport(random_, kMaxDetections);
  FillMessage(report, "left_optical", *detections_);
  const auto& out = detections_->value.detections;
  ASSERT_EQ(out._length, kMaxDetections);
  for (std::size_t i = 0; i < kMaxDetections; ++i) {
    const Detection& in = report.result.detections[i];
    const auto& ros = out._buffer[i];
    EXPECT_STREQ(ros.header.frame_id, "left_optical");
    EXPECT_EQ(std::string(ros.id), in.track_id == 0 ? "" : std::to_string(in.track_id));
    ASSERT_EQ(ros.results._length, std::max<std::size_t>(1, in.modes.size()));
    EXPECT_STREQ(ros.results._buffer[0].hypothesis.class_id, "juice_dispenser");
    // The box centre: middle of (-0.1, -0.2, 0) and (0.3, 0.2, 0.5), moved by the pose.
    const Vector3d centre = in.T_camera_model * Vector3d(0.1, 0, 0.25);
    EXPECT_NEAR(ros.bbox.center.position.x, centre.x(), 1e-7);
    EXPECT_NEAR(ros.bbox.center.position.y, centre.y(), 1e-7);
    EXPECT_NEAR(ros.bbox.center.position.z, centre.z(), 1e-7);
    EXPECT_NEAR(ros.bbox.size.x, 0.4, 1e-7);
    EXPECT_NEAR(ros.bbox.size.y, 0.4, 1e-7);
    EXPECT_NEAR(ros.bbox.size.z, 0.5, 1e-7);
  }
}

TEST_F(MessagesTest, UnambiguousDetectionHasOneResultWithItsPoseAndScore) {
  const FrameReport report = RandomReport(random_, 1);
  FillMessage(report, "camera", *detections_);
  const Detection& in = report.result.detections[0];
  const auto& result = detections_->value.detections._buffer[0].results._buffer[0];
  EXPECT_EQ(result.hypothesis.score, double{in.score});
  EXPECT_EQ(result.pose.pose.position.x, in.T_camera_model.t.x());
  EXPECT_EQ(result.pose.pose.position.y, in.T_camera_model.t.y());
  EXPECT_EQ(result.pose.pose.position.z, in.T_camera_model.t.z());
  const auto& q = result.pose.pose.orientation;
  EXPECT_LT((Turn({q.x, q.y, q.z, q.w}, {1, 2, 3}) - in.T_camera_model.R * Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_EQ(result.pose.covariance[0], in.covariance(3, 3));
}

TEST_F(MessagesTest, ModesAreResultsTheHeaviestFirst) {
  const FrameReport report = RandomReport(random_, 5);  // detection 4 has weights .1 .2 .3 .4
  FillMessage(report, "camera", *detections_);
  const Detection& in = report.result.detections[4];
  const auto& results = detections_->value.detections._buffer[4].results;
  ASSERT_EQ(results._length, 4u);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const PoseMode& mode = in.modes[3 - i];
    EXPECT_EQ(results._buffer[i].pose.pose.position.x, mode.T_camera_model.t.x());
    EXPECT_DOUBLE_EQ(results._buffer[i].hypothesis.score, double{in.score} * double{mode.weight});
  }
}

TEST_F(MessagesTest, ModesOfEqualWeightKeepTheirOrder) {
  FrameReport report = RandomReport(random_, 4);
  auto& modes = report.result.detections[3].modes;  // three
  for (PoseMode& mode : modes) mode.weight = 1.0F / 3;
  FillMessage(report, "camera", *detections_);
  const auto& results = detections_->value.detections._buffer[3].results;
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(results._buffer[i].pose.pose.position.x, modes[i].T_camera_model.t.x());
  }
}

TEST_F(MessagesTest, StampIsTheReportsAlsoBeforeZero) {
  FrameReport report;
  for (const auto& [ns, sec, nanosec] : {std::tuple{0LL, 0, 0u}, std::tuple{1'500'000'001LL, 1, 500'000'001u},
                                         std::tuple{-1LL, -1, 999'999'999u}, std::tuple{-1'000'000'000LL, -1, 0u}}) {
    report.stamp = std::chrono::nanoseconds(ns);
    FillMessage(report, "camera", *detections_);
    EXPECT_EQ(detections_->value.header.stamp.sec, sec);
    EXPECT_EQ(detections_->value.header.stamp.nanosec, nanosec);
  }
}

TEST_F(MessagesTest, NativeMessageCarriesEverything) {
  const FrameReport report = RandomReport(random_, 7);
  FillMessage(report, "left_optical", *recognition_);
  const wirepose_Recognition& out = recognition_->value;
  EXPECT_EQ(out.frame_sequence, report.sequence);
  EXPECT_EQ(out.capture_time_ns, report.capture_time.time_since_epoch().count());
  EXPECT_EQ(out.stamp_ns, report.stamp.count());
  EXPECT_STREQ(out.frame_id, "left_optical");
  EXPECT_TRUE(out.budget_hit);
  ASSERT_EQ(out.detections._length, 7u);
  for (std::size_t i = 0; i < 7; ++i) {
    const Detection& in = report.result.detections[i];
    const wirepose_Detection& native = out.detections._buffer[i];
    EXPECT_EQ(native.model_id, 7u);
    EXPECT_STREQ(native.name, "juice_dispenser");
    EXPECT_EQ(native.score, in.score);
    EXPECT_EQ(native.visible_fraction, in.visible_fraction);
    EXPECT_EQ(native.track_id, in.track_id);
    EXPECT_EQ(native.pose.position_m[1], in.T_camera_model.t.y());
    EXPECT_EQ(native.covariance[35], in.covariance(2, 2));
    ASSERT_EQ(native.modes._length, in.modes.size());
    for (std::size_t m = 0; m < in.modes.size(); ++m) {
      EXPECT_EQ(native.modes._buffer[m].weight, in.modes[m].weight);
      EXPECT_EQ(native.modes._buffer[m].pose.position_m[0], in.modes[m].T_camera_model.t.x());
    }
  }
}

TEST_F(MessagesTest, ListsAreReportedByName) {
  FillMessage(RandomReport(random_, 0), "camera", *recognition_);
  const auto& lists = recognition_->value.lists;
  ASSERT_EQ(lists._length, kRecognitionLists.size());
  EXPECT_STREQ(lists._buffer[2].name, "lines");
  EXPECT_EQ(lists._buffer[2].used, 84u);
  EXPECT_EQ(lists._buffer[2].capacity, 256u);
  EXPECT_EQ(lists._buffer[2].dropped, 3u);
}

TEST_F(MessagesTest, NamelessModelIsCalledByItsNumber) {
  const ModelView nameless[] = {test::MakeModel(7, "")};
  FrameReport report = RandomReport(random_, 1);
  report.models = LabelsOf(nameless, 1);
  FillMessage(report, "camera", *recognition_);
  EXPECT_STREQ(recognition_->value.detections._buffer[0].name, "7");
}

TEST_F(MessagesTest, HealthCarriesEverything) {
  HealthReport report;
  report.state = HealthState::kBadFrames;
  report.uptime_ns = 5;
  report.frames = {1, 2, 3, 4, 5, 6};
  report.camera = "replay";
  report.camera_status = "image damaged";
  report.last_error = "frame 3: image damaged";
  report.stage_times.push_back({FixedText<32>("rectify"), 10, 20, 30});
  report.results_dropped = 8;
  report.write_errors = 9;
  report.queue_high_water = 2;
  report.queue_capacity = 5;
  const auto message = std::make_unique<HealthMessage>();
  const ModelView models[] = {test::MakeModel(3, "box"), test::MakeModel(7, "juice_dispenser")};
  report.models = LabelsOf(models, 0b01);
  report.pool = {100, 200, 300, 4, 5};
  report.events = {1, 2, 3, 4, 5};
  FillMessage(report, "1.2.3", *message);
  const wirepose_Health& out = message->value;
  EXPECT_EQ(out.state, wirepose_BAD_FRAMES);
  EXPECT_STREQ(out.version, "1.2.3");
  EXPECT_EQ(out.uptime_ns, 5u);
  EXPECT_EQ(out.frames.good, 1u);
  EXPECT_EQ(out.frames.missing, 2u);
  EXPECT_EQ(out.frames.damaged, 3u);
  EXPECT_EQ(out.frames.not_synchronous, 4u);
  EXPECT_EQ(out.frames.late, 5u);
  EXPECT_EQ(out.frames.failed, 6u);
  EXPECT_STREQ(out.camera, "replay");
  EXPECT_STREQ(out.camera_status, "image damaged");
  EXPECT_STREQ(out.last_error, "frame 3: image damaged");
  ASSERT_EQ(out.stage_times._length, 1u);
  EXPECT_STREQ(out.stage_times._buffer[0].stage, "rectify");
  EXPECT_EQ(out.stage_times._buffer[0].p99_ns, 20u);
  EXPECT_EQ(out.queue_high_water, 2u);
  EXPECT_EQ(out.queue_capacity, 5u);
  EXPECT_EQ(out.results_dropped, 8u);
  EXPECT_EQ(out.write_errors, 9u);
  ASSERT_EQ(out.models._length, 2u);
  EXPECT_EQ(out.models._buffer[1].id, 7u);
  EXPECT_EQ(out.models._buffer[1].checksum, 0xC0FFEE07U);
  EXPECT_STREQ(out.models._buffer[1].name, "juice_dispenser");
  EXPECT_TRUE(out.models._buffer[0].searched);
  EXPECT_FALSE(out.models._buffer[1].searched);
  EXPECT_EQ(out.pool.used_bytes, 100u);
  EXPECT_EQ(out.pool.high_water_bytes, 200u);
  EXPECT_EQ(out.pool.capacity_bytes, 300u);
  EXPECT_EQ(out.events.subscribers, 1u);
  EXPECT_EQ(out.events.deadlines_missed, 2u);
  EXPECT_EQ(out.events.incompatible_qos, 3u);
  EXPECT_EQ(out.events.commands_accepted, 4u);
  EXPECT_EQ(out.events.commands_refused, 5u);
}

TEST(FixedText, CutsAtWholeCharacters) {
  EXPECT_TRUE(FixedText<4>("abc") == "abc");
  EXPECT_TRUE(FixedText<4>("abcd") == "abc");
  EXPECT_TRUE(FixedText<4>("ab\xC3\xA4") == "ab") << "the umlaut needs two bytes, one is left";
  EXPECT_TRUE(FixedText<5>("ab\xC3\xA4") == "ab\xC3\xA4");
  EXPECT_TRUE(FixedText<1>("a") == "");
  EXPECT_TRUE(FixedText<4>("") == "");
}

}  // namespace
}  // namespace wirepose
