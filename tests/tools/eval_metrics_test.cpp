// The measures against hand-computed cases and against an independent scorer, where one is at hand.
#include "tools/evaluation/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "eval_dataset.h"
#include "tools/evaluation/metrics_json.h"
#include "tools/evaluation/ply_vertices.h"
#include "tools/evaluation/pose_error.h"
#include "tools/evaluation/results_csv.h"

namespace wirepose::evaluation {
namespace {

using testing::TemporaryFolder;
using testing::WriteRandomDataset;
using testing::WriteText;

// A square of 100 mm in the plane z = 0 with the half turn about z; diameter 141.4 mm.
ObjectTruth Square() {
  ObjectTruth o;
  o.vertices_mm = {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}};
  o.diameter_mm = std::sqrt(2.0) * 100;
  RigidMm half;
  half.R = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  o.symmetries = {RigidMm{}, half};
  return o;
}

Matrix3d SomeCamera() {
  Matrix3d K = Matrix3d::Identity();
  K(0, 0) = K(1, 1) = 500;
  K(0, 2) = 320;
  K(1, 2) = 240;
  return K;
}

RigidMm At(double x, double y, double z) { return {Matrix3d::Identity(), {x, y, z}}; }

// One frame with the given true positions of object 1, all visible.
GroundTruth OneFrame(const std::vector<RigidMm>& poses) {
  GroundTruth truth;
  truth.objects[1] = Square();
  FrameTruth& frame = truth.frames.emplace_back();
  frame.scene_id = 1;
  frame.K = SomeCamera();
  for (const RigidMm& T : poses) frame.instances.push_back({1, T, 1});
  return truth;
}

Estimate Found(const RigidMm& T, double score, int object_id = 1) {
  Estimate e;
  e.scene_id = 1;
  e.object_id = object_id;
  e.score = score;
  e.T_camera_model = T;
  return e;
}

TEST(PoseError, OfAShiftIsTheShift) {
  const PoseError e = MeasurePose(Square(), SomeCamera(), At(3, 4, 1000), At(0, 0, 1000));
  EXPECT_NEAR(e.mssd_mm, 5, 1e-12);
  EXPECT_NEAR(e.mspd_px, 2.5, 1e-12);  // 5 mm at 1000 mm with f = 500 px
  EXPECT_NEAR(e.translation_mm, 5, 1e-12);
  EXPECT_NEAR(e.rotation_deg, 0, 1e-5);
}

TEST(PoseError, IgnoresASymmetricTurnButNotAQuarterTurn) {
  RigidMm turned = At(0, 0, 1000);
  turned.R = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  EXPECT_NEAR(MeasurePose(Square(), SomeCamera(), turned, At(0, 0, 1000)).mssd_mm, 0, 1e-12);
  turned.R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const PoseError quarter = MeasurePose(Square(), SomeCamera(), turned, At(0, 0, 1000));
  EXPECT_NEAR(quarter.mssd_mm, 100, 1e-9);  // each corner lands on its neighbour
  EXPECT_NEAR(quarter.rotation_deg, 90, 1e-9);
}

TEST(PoseError, ProjectionBehindTheCameraIsInfinite) {
  const PoseError e = MeasurePose(Square(), SomeCamera(), At(0, 0, -1000), At(0, 0, 1000));
  EXPECT_NEAR(e.mssd_mm, 2000, 1e-9);
  EXPECT_TRUE(std::isinf(e.mspd_px));
}

TEST(Symmetries, ContinuousOnesAreSampledAboutTheirAxis) {
  const auto all = EnumerateSymmetries({}, {{Vector3d(0, 0, 2), Vector3d(20, -10, 0)}});
  ASSERT_EQ(all.size(), 64u);
  for (const RigidMm& s : all) {
    EXPECT_NEAR((s * Vector3d(20, -10, 33) - Vector3d(20, -10, 33)).norm(), 0, 1e-12);
  }
  EXPECT_NEAR((all[16] * Vector3d(30, -10, 0) - Vector3d(20, 0, 0)).norm(), 0,
              1e-12);  // a quarter turn
}

TEST(Nees, IsTheMahalanobisDistanceOfTheTwist) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << 1e-4, 1e-4, 1e-4, 4e-6, 4e-6, 4e-6;  // 0.01 rad, 2 mm
  RigidMm truth = At(1, 2, 1000);
  truth.R = ExpSo3(Vector3d(0, 0.03, 0));
  EXPECT_NEAR(NormalizedErrorSquared(At(1, 2, 998), truth, covariance), 9 + 1, 1e-9);
  EXPECT_LT(NormalizedErrorSquared(truth, truth, -covariance), 0);
}

TEST(Nees, ChiSquareQuantilesGiveTheirShares) {
  EXPECT_NEAR(ChiSquare6Cdf(5.348120627447122), 0.50, 1e-12);
  EXPECT_NEAR(ChiSquare6Cdf(10.644640675668422), 0.90, 1e-12);
  EXPECT_NEAR(ChiSquare6Cdf(12.591587243743977), 0.95, 1e-12);
  EXPECT_NEAR(ChiSquare6Cdf(16.811893829770927), 0.99, 1e-12);
}

TEST(Percentile, InterpolatesBetweenOrderStatistics) {
  EXPECT_EQ(Percentile({}, 0.5), std::nullopt);
  EXPECT_DOUBLE_EQ(*Percentile({4}, 0.99), 4);
  EXPECT_DOUBLE_EQ(*Percentile({3, 1}, 0.5), 2);
  EXPECT_DOUBLE_EQ(*Percentile({10, 30, 20, 40}, 0.99), 39.7);
  EXPECT_DOUBLE_EQ(*Percentile({1, 2, 3}, 1), 3);
}

TEST(Matching, IsOneToOneAndPrefersInstancesThatCount) {
  const std::vector<std::vector<double>> errors{{1, 2}, {1, 3}, {1, 2}};
  EXPECT_THAT(MatchGreedily(errors, 10, {true, true}), ::testing::ElementsAre(0u, 1u, std::nullopt));
  EXPECT_THAT(MatchGreedily(errors, 10, {false, true}), ::testing::ElementsAre(1u, 0u, std::nullopt));
  EXPECT_THAT(MatchGreedily({{2}}, 2, {true}), ::testing::ElementsAre(std::nullopt)) << "strictly below the threshold";
}

TEST(Metrics, CountAHitAMissAndAFalseAlarm) {
  const GroundTruth truth = OneFrame({At(0, 0, 1000), At(300, 0, 1000)});
  const std::vector<Estimate> found{Found(At(3, 4, 1000), 0.5), Found(At(0, 0, 2000), 0.9)};
  const Metrics m = ComputeMetrics(truth, found);
  EXPECT_EQ(m.total.all.instances, 2);
  EXPECT_EQ(m.total.all.hits, 1);
  EXPECT_EQ(m.total.false_positives, 1);
  EXPECT_DOUBLE_EQ(*m.total.all.Recall(), 0.5);
  EXPECT_DOUBLE_EQ(*m.total.Precision(), 0.5);
  EXPECT_THAT(m.total.translation_errors_mm, ::testing::ElementsAre(::testing::DoubleNear(5, 1e-12)));
  EXPECT_DOUBLE_EQ(*m.total.AverageRecallMssd(),
                   0.5);  // 5 mm < 0.05 d: every threshold holds for one of two
  EXPECT_DOUBLE_EQ(*m.total.AverageRecallMspd(), 0.5);
  ASSERT_EQ(m.instances.size(), 2u);
  EXPECT_TRUE(m.instances[0].hit);
  EXPECT_FALSE(m.instances[1].hit);
  EXPECT_NEAR(*m.instances[1].best_mssd_mm, std::hypot(297, 4), 1e-9);
}

TEST(Metrics, AverageRecallCountsThresholdsAboveTheError) {
  const GroundTruth truth = OneFrame({At(0, 0, 1000)});
  const double d = std::sqrt(2.0) * 100;
  const Metrics m = ComputeMetrics(truth, std::vector<Estimate>{Found(At(0.22 * d, 0, 1000), 1)});
  EXPECT_EQ(m.total.all.hits, 0);
  EXPECT_DOUBLE_EQ(*m.total.AverageRecallMssd(), 0.6);  // 0.25 .. 0.5
  EXPECT_DOUBLE_EQ(*m.total.AverageRecallMspd(), 0.7);  // 15.56 px: 20 .. 50
}

TEST(Metrics, ADetectionOfAHardlyVisibleInstanceCountsNeitherWay) {
  GroundTruth truth = OneFrame({At(0, 0, 1000), At(300, 0, 1000)});
  truth.frames[0].instances[0].visible_fraction = 0.39;
  const Metrics m = ComputeMetrics(truth, std::vector<Estimate>{Found(At(0, 0, 1000), 1)});
  EXPECT_EQ(m.total.all.instances, 1);
  EXPECT_EQ(m.total.all.hits, 0);
  EXPECT_EQ(m.total.false_positives, 0);
  EXPECT_EQ(m.total.dont_care, 1);
  EXPECT_FALSE(m.total.Precision().has_value());
}

TEST(Metrics, UnknownObjectsAndEmptyFramesGiveFalseAlarms) {
  GroundTruth truth = OneFrame({});
  const Metrics m = ComputeMetrics(truth, std::vector<Estimate>{Found(At(0, 0, 1000), 1, 8)});
  EXPECT_EQ(m.negative_frames, 1);
  EXPECT_EQ(m.negative_false_positives, 1);
  EXPECT_EQ(m.per_object.at(8).false_positives, 1);
  EXPECT_FALSE(m.total.all.Recall().has_value());
}

TEST(Metrics, NeesIsCollectedFromHitsWithCovariance) {
  const GroundTruth truth = OneFrame({At(0, 0, 1000)});
  Estimate e = Found(At(0, 0, 1002), 1);
  e.covariance = Matrix6d::Identity() * 4e-6;  // 2 mm in each translation
  const Metrics m = ComputeMetrics(truth, std::vector<Estimate>{e});
  ASSERT_EQ(m.total.normalized_errors_squared.size(), 1u);
  EXPECT_NEAR(m.total.normalized_errors_squared[0], 1, 1e-9);
  EXPECT_DOUBLE_EQ(ToJson(m)["total"]["nees"]["coverage"]["50"].get<double>(), 1);
}

TEST(Results, ReadBackAsWritten) {
  TemporaryFolder folder;
  std::mt19937 random(3);
  std::vector<Estimate> written;
  for (int i = 0; i < 50; ++i) {
    Estimate e = Found({testing::RandomRotation(random), Vector3d(0.1, -1e-9, 1e5 / 3)}, 1.0 / 3);
    e.image_id = i;
    e.time_s = i / 7.0;
    written.push_back(e);
  }
  ASSERT_TRUE(WriteResults(folder.path() / "r.csv", written));
  const auto read = ReadResults(folder.path() / "r.csv");
  ASSERT_TRUE(read) << read.error();
  ASSERT_EQ(read->size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    EXPECT_EQ((*read)[i].T_camera_model.R, written[i].T_camera_model.R);
    EXPECT_EQ((*read)[i].T_camera_model.t_mm, written[i].T_camera_model.t_mm);
    EXPECT_EQ((*read)[i].score, written[i].score);
    EXPECT_EQ((*read)[i].time_s, written[i].time_s);
  }
}

TEST(Results, NameTheLineThatIsWrong) {
  TemporaryFolder folder;
  const auto file = folder.path() / "r.csv";
  for (const char* row : {"1,2,3", "1,2,x,0.5,1 0 0 0 1 0 0 0 1,1 2 3,0", "1,2,3,0.5,1 0 0 0 1 0 0 0,1 2 3,0",
                          "1,2,3,0.5,1 0 0 0 1 0 0 0 1,1 2,0", "1,2,3,0.5,1 0 0 0 1 0 0 0 1,1 2 3,soon"}) {
    WriteText(file, fmt::format("scene_id,im_id,obj_id,score,R,t,time\n{}\n", row));
    const auto read = ReadResults(file);
    ASSERT_FALSE(read) << row;
    EXPECT_THAT(read.error(), ::testing::HasSubstr("r.csv:2: ")) << row;
  }
}

TEST(GroundTruthReader, ReadsWhatTheDataSetSays) {
  TemporaryFolder folder;
  std::mt19937 random(1);
  WriteRandomDataset(folder.path(), random);
  const auto truth = ReadGroundTruth(folder.path());
  ASSERT_TRUE(truth) << truth.error();
  EXPECT_EQ(truth->frames.size(), 18u);
  EXPECT_EQ(truth->image_width_px, 752);
  EXPECT_EQ(truth->objects.at(1).symmetries.size(), 4u);
  EXPECT_EQ(truth->objects.at(2).vertices_mm.size(), 40u);
  EXPECT_EQ(truth->objects.at(5).symmetries.size(), 64u);
  EXPECT_EQ(truth->frames[1].image_id, 3);
}

struct Damage {
  const char* file;
  const char* text;  // null: the file is removed
  const char* message;
};

TEST(GroundTruthReader, NamesFileAndPlaceOfEveryDamage) {
  const Damage damages[] = {
      {"models/models_info.json", nullptr, "models_info.json: cannot be opened"},
      {"models/models_info.json", "{\"1\": {\"diam", "not valid JSON"},
      {"models/models_info.json", "[]", "no objects"},
      {"models/models_info.json", R"({"1": {}})", "object 1: 'diameter' is missing"},
      {"models/models_info.json", R"({"1": {"diameter": "big"}})", "a number is expected"},
      {"models/models_info.json", R"({"one": {"diameter": 1}})", "'one' is not an id"},
      {"models/models_info.json", R"({"1": {"diameter": 1, "symmetries_discrete": [[1]]}})", "16 numbers"},
      {"models/obj_000001.ply", nullptr, "obj_000001.ply: cannot be opened"},
      {"models/obj_000001.ply", "solid\n", "not a PLY header"},
      {"models/obj_000001.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
       "no x, y"},
      {"models/obj_000002.ply",
       "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
       "property float z\nend_header\n1 2 3\n4 5\n",
       "vertex 1: missing"},
      {"test/000001/scene_camera_cam1.json", "{\"0\": {}}", "image 0: 'cam_K' is missing"},
      {"test/000001/scene_gt_cam1.json", nullptr, "scene_gt_cam1.json: cannot be opened"},
      {"test/000001/scene_gt_cam1.json", R"({"0": 3})", "a list of instances"},
      {"test/000002/scene_gt_cam1.json", R"({"0": [{"obj_id": 4}]})", "unknown model id 4"},
      {"test/000002/scene_gt_cam1.json", R"({"0": [{"obj_id": 1, "cam_R_m2c": [1]}]})", "9 numbers"},
      {"test/000001/scene_gt_info_cam1.json", R"({"0": []})", "scene_gt"},
  };
  for (const Damage& damage : damages) {
    TemporaryFolder folder;
    std::mt19937 random(1);
    WriteRandomDataset(folder.path(), random);
    std::filesystem::remove(folder.path() / damage.file);
    if (damage.text != nullptr) WriteText(folder.path() / damage.file, damage.text);
    const auto truth = ReadGroundTruth(folder.path());
    ASSERT_FALSE(truth) << damage.file << ": " << damage.message;
    EXPECT_THAT(truth.error(), ::testing::HasSubstr(damage.message));
    EXPECT_THAT(truth.error(), ::testing::Not(::testing::HasSubstr("\n")));
  }
}

// Every number of `expected` must stand in `actual`.
void ExpectSame(const nlohmann::json& expected, const nlohmann::json& actual, const std::string& where) {
  if (expected.is_object()) {
    for (const auto& [key, value] : expected.items()) {
      ASSERT_TRUE(actual.contains(key)) << where << "/" << key;
      ExpectSame(value, actual.at(key), where + "/" + key);
    }
  } else if (expected.is_number()) {
    ASSERT_TRUE(actual.is_number()) << where << ": " << actual << " for " << expected;
    EXPECT_NEAR(actual.get<double>(), expected.get<double>(), 1e-6) << where;
  } else {
    EXPECT_EQ(actual, expected) << where;
  }
}

std::string OutputOf(const std::string& command) {
  std::string out;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return out;
  char buffer[4096];
  while (const std::size_t n = fread(buffer, 1, sizeof buffer, pipe)) out.append(buffer, n);
  return pclose(pipe) == 0 ? out : std::string();
}

TEST(Metrics, AgreeWithTheReferenceScorer) {
  const char* named = getenv("WIREPOSE_SCORE");
  const std::string script = named != nullptr ? named : WIREPOSE_SCORE_DEFAULT;
  if (!std::filesystem::exists(script)) GTEST_SKIP() << script << " is absent; name one by WIREPOSE_SCORE";
  // The system's python is the one that Debian's numpy belongs to.
  const std::string python = std::filesystem::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
  if (std::system((python + " -c 'import numpy' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "python3 with numpy is absent";
  for (unsigned seed = 1; seed <= 6; ++seed) {
    TemporaryFolder folder;
    std::mt19937 random(seed);
    WriteRandomDataset(folder.path(), random);
    const auto truth = ReadGroundTruth(folder.path());
    ASSERT_TRUE(truth) << truth.error();
    const auto estimates = testing::RandomEstimates(*truth, random);
    const Metrics metrics = ComputeMetrics(*truth, estimates);
    ASSERT_GT(metrics.total.all.hits, 0);
    ASSERT_TRUE(WriteResults(folder.path() / "r.csv", estimates));
    const std::string reference = OutputOf(fmt::format("{} '{}' '{}' '{}' --json 2>/dev/null", python, script,
                                                       (folder.path() / "r.csv").string(), folder.path().string()));
    ASSERT_FALSE(reference.empty()) << "the scorer failed";
    ExpectSame(nlohmann::json::parse(reference), ToJson(metrics), fmt::format("seed {}", seed));
  }
}

}  // namespace
}  // namespace wirepose::evaluation
