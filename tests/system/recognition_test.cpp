// The whole path with the real recognizer: rendered pictures go in, poses arrive over DDS in another process.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "hal/dataset/dataset.h"
#include "robot_test_base.h"

namespace wirepose::test {
namespace {

using Json = nlohmann::json;

constexpr int kFrames = 3;
constexpr int kDamagedFrame = 1;
constexpr int kParcel = 1, kDispenser = 3;
// Right: no corner of the bounding box is off by more than this part of the diameter (BOP's hits allow 0.1).
constexpr double kTolerance = 0.05;

// A model's shape as models_info.json tells it; metres.
struct ModelShape {
  double diameter_m = 0;
  std::vector<Vector3d> corners;
  std::vector<Pose> symmetries;  // identity included
};

ModelShape ReadShape(const Json& info) {
  ModelShape shape;
  shape.diameter_m = info.at("diameter").get<double>() / 1000;
  for (int i = 0; i < 8; ++i) {
    Vector3d corner;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name(1, "xyz"[axis]);
      const double size = info.at("size_" + name).get<double>();
      corner[axis] = (info.at("min_" + name).get<double>() + ((i >> axis) % 2) * size) / 1000;
    }
    shape.corners.push_back(corner);
  }
  shape.symmetries.emplace_back();
  for (const Json& m : info.value("symmetries_discrete", Json::array())) {
    Pose S;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) S.R(r, c) = m.at(4 * r + c).get<double>();
      S.t[r] = m.at(4 * r + 3).get<double>() / 1000;
    }
    shape.symmetries.push_back(S);
  }
  return shape;
}

Pose PoseOf(const Json& message) {
  const auto p = message.at("position_m").get<std::vector<double>>();
  const auto q = message.at("orientation_xyzw").get<std::vector<double>>();
  return {Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix(), {p[0], p[1], p[2]}};
}

// Largest distance of a corner, at the symmetry that suits best.
double Error(const ModelShape& shape, const Pose& estimate, const Pose& truth) {
  double best = std::numeric_limits<double>::max();
  for (const Pose& S : shape.symmetries) {
    double worst = 0;
    for (const Vector3d& p : shape.corners) worst = std::max(worst, (estimate * p - truth * (S * p)).norm());
    best = std::min(best, worst);
  }
  return best;
}

class RecognitionTest : public RobotTest {
 protected:
  void SetUp() override {
    RobotTest::SetUp();
    const std::filesystem::path meshes = std::filesystem::path(WIREPOSE_MESH).parent_path();
    Run({WIREPOSE_PROGRAM, "sim", "render", "--out", (folder_ / "data").string(), "--models", meshes.string(),
         "--scenario", WIREPOSE_SCENARIO, "--frames", std::to_string(kFrames), "--rate", "3", "--samples", "9"});
    const std::map<std::string, int> others = {{"book", 2}, {"juice_dispenser", kDispenser}};
    for (const auto& [name, id] : others) {
      Run({WIREPOSE_PROGRAM, "model", "build", (meshes / (name + ".ply")).string(), "--id", std::to_string(id), "--out",
           (folder_ / (name + ".wpm")).string()});
    }
    auto data = dataset::ReadDataset(folder_ / "data");
    ASSERT_TRUE(data) << data.error();
    truth_ = *std::move(data);
    ASSERT_EQ(truth_.frames.size(), std::size_t{kFrames});
    std::ifstream file(folder_ / "data/models/models_info.json");
    const Json info = Json::parse(file);
    for (const auto& [id, entry] : info.items()) shapes_[std::stoi(id)] = ReadShape(entry);
  }

  void Run(const std::vector<std::string>& command) const {
    Process process(folder_, "prepare", command);
    ASSERT_EQ(process.Wait(std::chrono::seconds(400)), 0) << process.Err();  // instrumented, it renders for 100 s
  }

  // Cuts the left picture in the middle, as a full disk does.
  void Damage(int frame) const {
    const std::filesystem::path& picture = truth_.frames[static_cast<std::size_t>(frame)].left_path;
    std::filesystem::resize_file(picture, std::filesystem::file_size(picture) / 2);
  }

  // Of a detection: how far it is from the nearest true instance of its model, in diameters.
  [[nodiscard]] double RelativeError(int frame, const Json& detection) const {
    const int id = detection.at("model_id").get<int>();
    const ModelShape& shape = shapes_.at(id);
    double best = std::numeric_limits<double>::max();
    for (const dataset::TrueInstance& instance : truth_.frames[static_cast<std::size_t>(frame)].gt) {
      if (instance.obj_id != id) continue;
      best = std::min(best, Error(shape, PoseOf(detection.at("pose")), instance.T_camera_model));
    }
    return best / shape.diameter_m;
  }

  dataset::Dataset truth_;
  std::map<int, ModelShape> shapes_;
};

TEST_F(RecognitionTest, TruePosesArriveAndADamagedFrameIsSurvived) {
  Damage(kDamagedFrame);
  const std::string config = WriteConfig(
      "camera:\n  backend: replay\n  timeout_ms: 30000\n"
      "  replay: { data_set: data, loop: true, frame_rate_hz: 10 }\n"
      "dds: { domain: " +
      domain_ + ", loopback: true }\nmodels: [.]\n");
  Process robot(folder_, "robot", Robot(config));
  Process watch(folder_, "watch", Watch({"--frames", "4", "--timeout", "60"}));
  ASSERT_EQ(watch.Wait(std::chrono::seconds(120)), 0) << watch.Err() << robot.Err();
  robot.Signal(SIGTERM);
  EXPECT_EQ(robot.Wait(), 0) << robot.Err();

  int recognized = 0;
  bool damage_reported = false;
  for (const std::string& line : watch.OutLines()) {
    const Json message = Json::parse(line);
    if (message["topic"] == "health") {
      damage_reported |= message["state"] == "bad_frames" && message["camera_status"] == "image damaged";
    }
    if (message["topic"] != "recognition") continue;
    ++recognized;
    const int frame = message["frame_sequence"].get<int>() % kFrames;
    EXPECT_NE(frame, kDamagedFrame);
    // What is reported beside the true objects is not this test's affair: evaluation counts false alarms.
    std::set<int> ids;
    for (const Json& detection : message["detections"]) {
      if (RelativeError(frame, detection) < kTolerance) ids.insert(detection["model_id"].get<int>());
    }
    EXPECT_TRUE(ids.contains(kDispenser) && ids.contains(kParcel)) << "frame " << frame << ": " << message.dump();
  }
  EXPECT_EQ(recognized, 4);
  EXPECT_TRUE(damage_reported) << watch.Out();
}

}  // namespace
}  // namespace wirepose::test
