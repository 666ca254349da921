// `wirepose eval` as a program: what it writes, and what it says of bad input.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "eval_dataset.h"
#include "hal/dataset/dataset_writer.h"
#include "tools/evaluation/evaluate.h"
#include "tools/evaluation/results_csv.h"

namespace wirepose::evaluation {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::WriteText;

constexpr int kWidth = 160;
constexpr int kHeight = 120;

constexpr const char* kBoxPly =
    "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 6\nproperty list uchar int vertex_indices\nend_header\n"
    "-50 -40 -30\n50 -40 -30\n-50 40 -30\n50 40 -30\n-50 -40 30\n50 -40 30\n-50 40 30\n50 40 30\n"
    "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";

dataset::GrayImage Noise(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  dataset::GrayImage image;
  image.width = width;
  image.height = height;
  for (int i = 0; i < width * height; ++i) image.pixels.push_back(static_cast<std::uint8_t>(random()));
  return image;
}

StereoCalibration SmallRig() {
  StereoCalibration c;
  c.left.fx = c.left.fy = c.right.fx = c.right.fy = 150;
  c.left.cx = c.right.cx = 80;
  c.left.cy = c.right.cy = 60;
  c.T_right_left.t = {-0.1, 0, 0};
  c.width = kWidth;
  c.height = kHeight;
  return c;
}

// A good data set of two frames, each with one box that the noise does not show.
void WriteDataset(const fs::path& root) {
  auto writer = dataset::DatasetWriter::Create(root, SmallRig());
  ASSERT_TRUE(writer) << writer.error();
  for (int i = 0; i < 2; ++i) {
    dataset::FrameRecord record;
    record.im_id = i;
    dataset::InstanceRecord& box = record.instances.emplace_back();
    box.obj_id = 1;
    box.T_left_model.t = {0, 0, 1};
    box.visib_fract = 1;
    const auto left = Noise(kWidth, kHeight, 1), right = Noise(kWidth, kHeight, 2);
    ASSERT_TRUE(writer->AddFrame(1, record, left.view(), right.view(), {}));
  }
  ASSERT_TRUE(writer->FinishScene(1));
  WriteText(root / "models/obj_000001.ply", kBoxPly);
  WriteText(root / "models/models_info.json", R"({"1": {"diameter": 141.42}})");
}

// The same two frames as one camera with depth sees them: the noise 1 m away.
void WriteDepthDataset(const fs::path& root) {
  const std::vector<std::uint16_t> depth(kWidth * kHeight, 1000);
  for (const char* name : {"000000.png", "000001.png"}) {
    for (const char* folder : {"rgb", "depth"}) fs::create_directories(root / "test/000001" / folder);
    ASSERT_TRUE(dataset::WriteGrayPng(root / "test/000001/rgb" / name, Noise(kWidth, kHeight, 1).view()));
    ASSERT_TRUE(dataset::WriteDepthPng(root / "test/000001/depth" / name, {depth.data(), kWidth, kHeight, kWidth}));
  }
  const std::string K = R"({"cam_K": [150, 0, 80, 0, 150, 60, 0, 0, 1], "depth_scale": 1.0})";
  const std::string box = R"([{"obj_id": 1, "cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,1000]}])";
  WriteText(root / "test/000001/scene_camera.json", "{\"0\": " + K + ", \"1\": " + K + "}");
  WriteText(root / "test/000001/scene_gt.json", "{\"0\": " + box + ", \"1\": " + box + "}");
  WriteText(root / "models/obj_000001.ply", kBoxPly);
  WriteText(root / "models/models_info.json", R"({"1": {"diameter": 141.42}})");
}

struct Outcome {
  int status = -1;
  std::string out, err;
};

std::string TextOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

Outcome Wirepose(const fs::path& scratch, const std::string& arguments) {
  const std::string command =
      fmt::format("cd '{0}' && '{1}' {2} >out.txt 2>err.txt", scratch.string(), WIREPOSE_PROGRAM, arguments);
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, TextOf(scratch / "out.txt"), TextOf(scratch / "err.txt")};
}

TEST(EvalCommand, WritesRowsJsonAndTable) {
  TemporaryFolder folder;
  WriteDataset(folder.path() / "set");
  const Outcome run = Wirepose(folder.path(), "eval set --out r.csv --json m.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("2 frames"));
  ASSERT_TRUE(ReadResults(folder.path() / "r.csv"));
  const auto json = nlohmann::json::parse(TextOf(folder.path() / "m.json"));
  EXPECT_EQ(json.at("frames"), 2);
  EXPECT_EQ(json.at("total").at("instances"), 2);
  EXPECT_EQ(json.at("instances").size(), 2u);
  EXPECT_EQ(json.at("per_frame").size(), 2u);
  for (const char* stage : {"rectify", "segments", "refine", "frame"}) {
    EXPECT_TRUE(json.at("stages").at(stage).at("wall_ms").contains("p99")) << stage;
  }
  EXPECT_GT(json.at("stages").at("frame").at("wall_ms").at("p50").get<double>(), 0);
  EXPECT_TRUE(json.at("lists").at("hypotheses").contains("high_water"));
}

TEST(EvalCommand, LimitsFramesAndTruthTogether) {
  TemporaryFolder folder;
  WriteDataset(folder.path() / "set");
  ASSERT_EQ(Wirepose(folder.path(), "eval set --out r.csv --json m.json --limit 1").status, 0);
  const auto json = nlohmann::json::parse(TextOf(folder.path() / "m.json"));
  EXPECT_EQ(json.at("frames"), 1);
  EXPECT_EQ(json.at("total").at("instances"), 1);
}

TEST(EvalCommand, ReadsModelFiles) {
  TemporaryFolder folder;
  WriteDataset(folder.path() / "set");
  ASSERT_EQ(Wirepose(folder.path(), "model build set/models/obj_000001.ply --id 1 --name box --out box.wpm").status, 0);
  const Outcome run = Wirepose(folder.path(), "eval set --models box.wpm --out r.csv");
  EXPECT_EQ(run.status, 0) << run.err;
}

TEST(EvalCommand, TurnsDetectionsIntoRows) {
  Detection detection;
  detection.model_id = 3;
  detection.score = 0.5F;
  detection.T_camera_model = {ExpSo3({0.1, 0.2, 0.3}), {0.1, -0.2, 1.5}};
  detection.covariance = Matrix6d::Identity() * 2;
  dataset::FrameEntry entry;
  entry.scene_id = 7;
  entry.im_id = 9;
  const Estimate e = ToEstimate(detection, entry, 0.02);
  EXPECT_EQ(e.scene_id, 7);
  EXPECT_EQ(e.image_id, 9);
  EXPECT_EQ(e.object_id, 3);
  EXPECT_EQ(e.score, 0.5);
  EXPECT_EQ(e.time_s, 0.02);
  EXPECT_EQ(e.T_camera_model.R, detection.T_camera_model.R);
  EXPECT_NEAR((e.T_camera_model.t_mm - Vector3d(100, -200, 1500)).norm(), 0, 1e-12);
  EXPECT_EQ(*e.covariance, detection.covariance);
}

// A way to spoil the good data set at `root`, and what must come of it.
struct BadInput {
  const char* name;
  std::function<void(const fs::path& root)> spoil;
  std::string arguments;
  int status;
  const char* message;
};

class BadInputTest : public ::testing::TestWithParam<BadInput> {};

TEST_P(BadInputTest, GivesOneLineAndAStatus) {
  TemporaryFolder folder;
  WriteDataset(folder.path() / "set");
  GetParam().spoil(folder.path() / "set");
  const Outcome run = Wirepose(folder.path(), GetParam().arguments);
  EXPECT_EQ(run.status, GetParam().status) << run.err;
  EXPECT_THAT(run.err, HasSubstr(GetParam().message));
  EXPECT_THAT(run.err, ::testing::StartsWith("wirepose: "));
  EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
}

TEST(EvalCommand, RecognizesADataSetOfOneCameraWithDepth) {
  TemporaryFolder folder;
  WriteDepthDataset(folder.path() / "set");
  const Outcome run = Wirepose(folder.path(), "eval set --out r.csv --json m.json --report r.html --overlay o");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto json = nlohmann::json::parse(TextOf(folder.path() / "m.json"));
  EXPECT_EQ(json.at("frames"), 2);
  EXPECT_EQ(json.at("total").at("instances"), 2);
  EXPECT_TRUE(fs::exists(folder.path() / "r.html"));
}

TEST(EvalCommand, NamesBadDepthInOneLine) {
  TemporaryFolder folder;
  const fs::path set = folder.path() / "set", depth = set / "test/000001/depth/000001.png";
  WriteDepthDataset(set);
  const auto expect = [&](const std::string& message) {
    const Outcome run = Wirepose(folder.path(), "eval set --out r.csv");
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.err, HasSubstr(message));
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
  };
  const std::vector<std::uint16_t> pixels(80 * 60, 1000);
  ASSERT_TRUE(dataset::WriteDepthPng(depth, {pixels.data(), 80, 60, 80}));
  expect("depth/000001.png: 80x60 pixels, but the image it is registered to says 160x120");
  ASSERT_TRUE(dataset::WriteGrayPng(depth, Noise(kWidth, kHeight, 1).view()));
  expect("depth/000001.png");
  fs::remove(depth);
  expect("depth/000001.png");
}

std::function<void(const fs::path&)> Remove(const std::string& file) {
  return [file](const fs::path& root) { fs::remove_all(root / file); };
}

std::function<void(const fs::path&)> Put(const std::string& file, const std::string& text) {
  return [file, text](const fs::path& root) { WriteText(root / file, text); };
}

// Replaces the first occurrence in a file that must have it.
std::function<void(const fs::path&)> Edit(const std::string& file, const std::string& from, const std::string& to) {
  return [=](const fs::path& root) {
    std::string text = TextOf(root / file);
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << file << " has no " << from;
    WriteText(root / file, text.replace(at, from.size(), to));
  };
}

void PutSmallerImage(const fs::path& root) {
  ASSERT_TRUE(dataset::WriteGrayPng(root / "test/000001/gray_cam2/000001.png", Noise(80, 60, 3).view()));
}

void PutDeepImage(const fs::path& root) {
  const std::vector<std::uint16_t> pixels(kWidth * kHeight, 5000);
  ASSERT_TRUE(
      dataset::WriteDepthPng(root / "test/000001/gray_cam1/000000.png", {pixels.data(), kWidth, kHeight, kWidth}));
}

void Nothing(const fs::path&) {}

constexpr const char* kLeft0 = "test/000001/gray_cam1/000000.png";
const std::string kEval = "eval set --out r.csv";

const BadInput kBadInputs[] = {
    {"NoSubcommand", Nothing, "", 2, "subcommand"},
    {"UnknownOption", Nothing, kEval + " --frob", 2, "--frob"},
    {"NoOut", Nothing, "eval set", 2, "--out is required"},
    {"NoDataset", Nothing, "eval nowhere --out r.csv", 1, "nowhere"},
    {"OutInNoFolder", Nothing, "eval set --out no/where/r.csv", 2, "no/where/r.csv"},
    {"JsonInNoFolder", Nothing, kEval + " --json no/where/m.json", 2, "no/where/m.json"},
    {"ReportInNoFolder", Nothing, kEval + " --report no/where/r.html", 2, "no/where/r.html"},
    {"NegativeLimit", Nothing, kEval + " --limit -1", 2, "--limit"},
    {"CalibrationMissing", Remove("calib.yaml"), kEval, 1, "calib.yaml"},
    {"CalibrationEmpty", Put("calib.yaml", ""), kEval, 1, "calib.yaml"},
    {"CalibrationNotYaml", Put("calib.yaml", "%YAML:1.0\n---\nK1: [1, 2\n"), kEval, 1, "calib.yaml"},
    {"CalibrationWithoutT", Edit("calib.yaml", "\nT:", "\nS:"), kEval, 1, "calib.yaml"},
    {"CalibrationTooLarge", Edit("calib.yaml", "image_width: 160", "image_width: 1600"), kEval, 1, "calib.yaml"},
    {"ImageMissing", Remove(kLeft0), kEval, 1, "000000.png"},
    {"ImageEmpty", Put(kLeft0, ""), kEval, 1, "000000.png"},
    {"ImageNotPng", Put(kLeft0, "GIF89a and so on"), kEval, 1, "000000.png"},
    {"ImageOfWrongSize", PutSmallerImage, kEval, 1, "000001.png: 80x60 pixels, but calib.yaml says 160x120"},
    {"ImageOfWrongDepth", PutDeepImage, kEval, 1, "000000.png"},
    {"NoScenes", Remove("test/000001"), kEval, 1, "test"},
    {"NoTestFolder", Remove("test"), kEval, 1, "test"},
    {"CameraMissing", Remove("test/000001/scene_camera_cam1.json"), kEval, 1, "scene_camera_cam1.json"},
    {"TruthMissing", Remove("test/000001/scene_gt_cam1.json"), kEval, 1, "scene_gt_cam1.json"},
    {"TruthNotJson", Put("test/000001/scene_gt_cam1.json", "{\"0\": ["), kEval, 1, "scene_gt_cam1.json"},
    {"TruthOfUnknownModel", Edit("test/000001/scene_gt_cam1.json", "\"obj_id\": 1", "\"obj_id\": 8"), kEval, 1,
     "unknown model id 8"},
    {"NoModels", Remove("models/obj_000001.ply"), kEval, 1, "obj_000001.ply"},
    {"NoModelsInfo", Remove("models/models_info.json"), kEval, 1, "models_info.json"},
    {"MeshMalformed", Put("models/obj_000001.ply", "ply\nformat ascii 1.0\n"), kEval, 1, "obj_000001.ply"},
    {"ModelFileMissing", Nothing, kEval + " --models none.wpm", 1, "none.wpm"},
    {"ModelFileMalformed", Put("bad.wpm", "WPM1 or so"), kEval + " --models set/bad.wpm", 1, "bad.wpm"},
    {"ModelFolderEmpty", Nothing, kEval + " --models set/test", 1, "no models"},
    {"UnknownModelId", Nothing, kEval + " --objects 1,5", 1, "unknown model id 5"},
    {"OverlayOnAFile", Nothing, kEval + " --overlay set/calib.yaml", 1, "calib.yaml"},
};

INSTANTIATE_TEST_SUITE_P(EvalCommand, BadInputTest, ::testing::ValuesIn(kBadInputs),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(EvalCommand, RefusesAModelTheDataSetDoesNotKnow) {
  TemporaryFolder folder;
  WriteDataset(folder.path() / "set");
  ASSERT_EQ(Wirepose(folder.path(), "model build set/models/obj_000001.ply --id 6 --name box --out box.wpm").status, 0);
  const Outcome run = Wirepose(folder.path(), "eval set --models box.wpm --out r.csv");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("unknown model id 6"));
}

}  // namespace
}  // namespace wirepose::evaluation
