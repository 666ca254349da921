// What arrived over DDS against what the simulated camera knew.
#include "tools/evaluation/streams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "box_model.h"
#include "eval_dataset.h"

namespace wirepose::evaluation {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::WriteText;
using wirepose::testing::BoxModel;

class StreamsTest : public ::testing::Test {
 protected:
  StreamsTest() : box_(0.3F, 0.2F, 0.1F) { models_.views.push_back(box_.view()); }

  [[nodiscard]] std::filesystem::path Write(const std::string& text) const {
    WriteText(folder_.path() / "stream.jsonl", text);
    return folder_.path() / "stream.jsonl";
  }

  TemporaryFolder folder_;
  BoxModel box_;
  ModelSet models_;
};

constexpr const char* kTruth =
    R"({"sequence":1,"objects":[{"obj_id":1,"R":[0,-1,0,1,0,0,0,0,1],"t":[0.1,0,1],"visib_fract":0.9}]}
{"sequence":0,"objects":[{"obj_id":9,"R":[1,0,0,0,1,0,0,0,1],"t":[0,0,1],"visib_fract":1}]}
)";

// The same pose as in frame 1 of kTruth but 3 mm to the right; a quarter turn about z as
// quaternion.
constexpr const char* kReceived =
    R"({"topic":"health","state":"running"}
{"topic":"recognition","frame_sequence":1,"detections":[{"model_id":1,"score":0.75,"pose":{"position_m":[0.103,0,1],"orientation_xyzw":[0,0,0.7071067811865476,0.7071067811865476]}}]}
)";

TEST_F(StreamsTest, APoseThatArrivedIsComparedWithItsFrame) {
  auto truth = ReadTruthStream(Write(kTruth), models_);
  ASSERT_TRUE(truth) << truth.error();
  ASSERT_EQ(truth->frames.size(), 2u);
  EXPECT_EQ(truth->frames[0].image_id, 0);
  EXPECT_TRUE(truth->frames[0].instances.empty()) << "nobody searches for model 9";
  EXPECT_NEAR(truth->objects.at(1).diameter_mm, 374.166, 1e-3);
  const auto received = ReadReceivedStream(Write(kReceived));
  ASSERT_TRUE(received) << received.error();
  KeepFrames(received->frames, *truth);
  ASSERT_EQ(truth->frames.size(), 1u);
  const Metrics m = ComputeMetrics(*truth, received->estimates);
  EXPECT_EQ(m.total.all.hits, 1);
  ASSERT_EQ(m.instances.size(), 1u);
  EXPECT_TRUE(m.instances[0].hit);
  EXPECT_EQ(m.instances[0].score, 0.75);
  EXPECT_NEAR(m.instances[0].translation_mm, 3, 1e-9);
  EXPECT_NEAR(m.instances[0].rotation_deg, 0, 1e-5);
  EXPECT_NEAR(m.instances[0].estimate.t_mm.x(), 103, 1e-9);
}

TEST_F(StreamsTest, SymmetriesOfTheModelCount) {
  ModelSymmetry half_turn{{-1, 0, 0, 0, -1, 0, 0, 0, 1}, {0, 0, 0}};
  models_.views[0].symmetries = {&half_turn, 1};
  const auto truth = ReadTruthStream(Write(kTruth), models_);
  ASSERT_TRUE(truth) << truth.error();
  const RigidMm& symmetry = truth->objects.at(1).symmetries.at(1);
  EXPECT_NEAR((symmetry * Vector3d(1, 2, 3) - Vector3d(-1, -2, 3)).norm(), 0, 1e-9);
}

TEST_F(StreamsTest, FaultsNameFileAndLine) {
  for (const char* bad : {"{\"sequence\":0,\"objects\":[]}\nnot json\n", "{\"sequence\":0,\"objects\":[]}\n{}\n",
                          "{\"sequence\":0,\"objects\":[]}\n{\"sequence\":1,\"objects\":[{\"obj_id\":1}]}\n"}) {
    const auto truth = ReadTruthStream(Write(bad), models_);
    ASSERT_FALSE(truth) << bad;
    EXPECT_THAT(truth.error(), HasSubstr("stream.jsonl:2: "));
  }
  const auto short_pose = ReadReceivedStream(Write(
      R"({"frame_sequence":0,"detections":[{"model_id":1,"score":1,"pose":{"position_m":[1],"orientation_xyzw":[0,0,0,1]}}]})"));
  ASSERT_FALSE(short_pose);
  EXPECT_THAT(short_pose.error(), HasSubstr("stream.jsonl:1: "));
}

TEST_F(StreamsTest, NothingReceivedIsAnError) {
  const auto silent = ReadReceivedStream(Write("{\"topic\":\"health\"}\n"));
  ASSERT_FALSE(silent);
  EXPECT_THAT(silent.error(), HasSubstr("no message of wirepose/recognition"));
  EXPECT_FALSE(ReadTruthStream(Write(""), models_));
  EXPECT_FALSE(ReadTruthStream(folder_.path() / "absent.jsonl", models_));
}

}  // namespace
}  // namespace wirepose::evaluation
