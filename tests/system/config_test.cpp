#include "app/config.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <random>
#include <sstream>

#include "app/failure.h"

namespace wirepose::app {
namespace {

class ConfigTest : public ::testing::Test {
 protected:
  ConfigTest()
      : file_(std::filesystem::temp_directory_path() / ("wirepose_config_" + std::to_string(getpid()) + ".yaml")) {}
  ~ConfigTest() override { std::filesystem::remove(file_); }

  Config Load(const std::string& text) const {
    std::ofstream(file_, std::ios::binary) << text;
    return LoadConfig(file_);
  }
  // The message without the file's name, or "accepted".
  std::string Refusal(const std::string& text) const {
    try {
      (void)Load(text);
      return "accepted";
    } catch (const UsageError& e) {
      const std::string what = e.what();
      EXPECT_EQ(what.rfind(file_.string(), 0), 0u) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      return what.substr(file_.string().size());
    }
  }

  std::filesystem::path file_;
};

TEST_F(ConfigTest, EmptyFileGivesDefaults) {
  const Config config = Load("");
  EXPECT_EQ(config.camera.backend, CameraBackend::kUnset);
  EXPECT_EQ(config.dds.bus.domain, 0u);
  EXPECT_FALSE(config.dds.bus.loopback);
  EXPECT_EQ(config.dds.frame_id, "wirepose_left_optical");
  EXPECT_TRUE(config.models.empty());
  EXPECT_TRUE(config.tracking);
}

TEST_F(ConfigTest, ReadsEveryKey) {
  const Config config = Load(R"(
camera:
  backend: simulated
  timeout_ms: 250
  replay: { data_set: /data/set, split: train, scene: 4, loop: true, frame_rate_hz: 12.5 }
  simulated: { meshes: meshes, calibration: rig.yaml, seed: 9, frames: 100, loop_frames: 12, frame_rate_hz: 15, samples_per_pixel: 25, truth_file: truth.jsonl }
dds: { domain: 42, loopback: true, frame_id: eye }
recognizer: { tracking: false }
models: [a.wpm, /b]
search_for: [3, 1]
)");
  const std::filesystem::path folder = file_.parent_path();
  EXPECT_EQ(config.camera.backend, CameraBackend::kSimulated);
  EXPECT_EQ(config.camera.timeout.count(), 250);
  EXPECT_EQ(config.camera.replay.root, "/data/set");
  EXPECT_EQ(config.camera.replay.split, "train");
  EXPECT_EQ(config.camera.replay.scene_id, 4);
  EXPECT_TRUE(config.camera.replay.loop);
  EXPECT_EQ(config.camera.replay.frame_rate_hz, 12.5);
  EXPECT_EQ(config.camera.simulated.mesh_dir, folder / "meshes");
  EXPECT_EQ(config.camera.simulated.calibration_path, folder / "rig.yaml");
  EXPECT_EQ(config.camera.simulated.seed, 9u);
  EXPECT_EQ(config.camera.simulated.frame_count, 100u);
  EXPECT_EQ(config.camera.simulated.loop_frames, 12u);
  EXPECT_EQ(config.camera.simulated.frame_rate_hz, 15);
  EXPECT_EQ(config.camera.simulated.samples_per_pixel, 25);
  EXPECT_EQ(config.camera.simulated.truth_path, folder / "truth.jsonl");
  EXPECT_FALSE(config.tracking);
  EXPECT_EQ(config.dds.bus.domain, 42u);
  EXPECT_TRUE(config.dds.bus.loopback);
  EXPECT_EQ(config.dds.frame_id, "eye");
  EXPECT_EQ(config.models, (std::vector<std::filesystem::path>{folder / "a.wpm", "/b"}));
  EXPECT_EQ(config.search_for, (std::vector<std::uint32_t>{3, 1}));
}

TEST_F(ConfigTest, TheExampleIsValid) {
  EXPECT_EQ(LoadConfig(WIREPOSE_EXAMPLE_CONFIG).camera.backend, CameraBackend::kSimulated);
}

TEST_F(ConfigTest, RefusalsNameLineKeyAndRemedy) {
  EXPECT_EQ(Refusal("a: 1\n"), ":1: a: unknown key; known here: camera, dds, models, recognizer, search_for");
  EXPECT_EQ(Refusal("dds:\n  domain: 5\n  domian: 6\n"),
            ":3: dds.domian: unknown key; known here: domain, frame_id, loopback, pool_kib, security, stamp, "
            "topics");
  EXPECT_EQ(Refusal("dds:\n  domain: 231\n"), ":2: dds.domain: '231' is not a whole number from 0 to 230");
  EXPECT_EQ(Refusal("dds:\n  domain: -1\n"), ":2: dds.domain: '-1' is not a whole number from 0 to 230");
  EXPECT_EQ(Refusal("dds:\n  domain: 1x\n"), ":2: dds.domain: '1x' is not a whole number from 0 to 230");
  EXPECT_EQ(Refusal("dds:\n  domain: [1]\n"), ":2: dds.domain: needs a whole number");
  EXPECT_EQ(Refusal("\n\ndds:\n  loopback: maybe\n"),
            ":4: dds.loopback: 'maybe' is not a truth value; write true or false");
  EXPECT_EQ(Refusal("dds: { domain: 1, domain: 2 }\n"), ":1: dds.domain: stands here twice; remove one");
  EXPECT_EQ(Refusal("dds: 7\n"), ":1: dds: not a mapping; write 'key: value' lines");
  EXPECT_EQ(Refusal("models: a.wpm\n"), ":1: models: needs a list of paths, as [a, b]");
  EXPECT_EQ(Refusal("search_for: [one]\n"), ":1: search_for: not a model id; write whole numbers");
  EXPECT_EQ(Refusal("camera:\n  replay:\n    frame_rate_hz: nan\n"),
            ":3: camera.replay.frame_rate_hz: 'nan' is not a number from 0 to 1000");
  EXPECT_EQ(Refusal("camera: { timeout_ms: 70000 }\n"),
            ":1: camera.timeout_ms: '70000' is not a whole number from 10 to 60000");
  EXPECT_NE(Refusal("camera: { backend: kodak }\n").find("no camera 'kodak'"), std::string::npos);
  EXPECT_NE(Refusal("dds: { frame_id: " + std::string(64, 'x') + " }").find("longer than 63"), std::string::npos);
}

TEST_F(ConfigTest, TopicsPoolAndStamp) {
  const Config config = Load(R"(
dds:
  stamp: capture
  pool_kib: 4096
  topics:
    detections: { name: rt/robot1/objects, reliable: false, depth: 2, deadline_ms: 100 }
)");
  EXPECT_EQ(config.dds.stamp, StampSource::kCapture);
  EXPECT_EQ(config.dds.pool_bytes, 4096U << 10);
  const TopicSettings& detections = config.dds.bus.topics[static_cast<std::size_t>(TopicId::kDetections)];
  EXPECT_EQ(detections.name, "rt/robot1/objects");
  EXPECT_FALSE(detections.reliable);
  EXPECT_EQ(detections.depth, 2);
  EXPECT_EQ(detections.deadline.count(), 100);
  EXPECT_EQ(config.dds.bus.topics[static_cast<std::size_t>(TopicId::kHealth)].name, "wirepose/health");
  EXPECT_FALSE(config.dds.bus.security);

  EXPECT_EQ(Refusal("dds: { stamp: now }\n"), ":1: dds.stamp: neither system nor capture");
  EXPECT_EQ(Refusal("dds: { topics: { health: { depth: 2 } } }\n"),
            ":1: dds.topics.health.depth: '2' is not a whole number from 1 to 1");
  EXPECT_NE(Refusal("dds: { topics: { health: { name: /a b } } }\n").find("not a topic name"), std::string::npos);
  EXPECT_NE(Refusal("dds: { topics: { health: { name: wirepose/recognition } } }\n").find("two topics"),
            std::string::npos);
  EXPECT_NE(Refusal("dds: { topics: { weather: {} } }\n").find("dds.topics.weather: unknown key"), std::string::npos);
}

TEST_F(ConfigTest, SecurityNeedsAllItsFiles) {
  const std::string file = file_.string();
  EXPECT_NE(
      Refusal("dds:\n  security: { governance: nowhere.p7s }\n").find(":2: dds.security.governance: no such file"),
      std::string::npos);
  EXPECT_NE(Refusal("dds:\n  security: { governance: " + file + " }\n").find("needs all six files"), std::string::npos);
  const Config config =
      Load("dds:\n  security: { identity_ca: " + file + ", certificate: " + file + ", private_key: " + file +
           ", permissions_ca: " + file + ", governance: " + file + ", permissions: " + file + " }\n");
  ASSERT_TRUE(config.dds.bus.security);
  EXPECT_EQ(config.dds.bus.security->permissions, file);
  EXPECT_EQ(config.dds.pool_bytes, kDefaultSecuredDdsPoolBytes);
}

TEST_F(ConfigTest, WhatIsNotYamlIsRefusedWithItsLine) {
  EXPECT_EQ(Refusal("dds:\n  domain: [1, 2\nmodels: }\n").rfind(":", 0), 0u);
  EXPECT_NE(Refusal("dds: *nowhere\n").find("not YAML"), std::string::npos);
  EXPECT_EQ(Refusal("- a\n- b\n"), ":1: not a mapping; write 'key: value' lines");
  EXPECT_EQ(Refusal("just words\n"), ":1: not a mapping; write 'key: value' lines");
  EXPECT_NE(Refusal(std::string(2 << 20, '#')).find("larger than 1 MiB"), std::string::npos);
}

// Random damage to a good file: accepted or refused, never a crash or another kind of exception.
TEST_F(ConfigTest, DamagedFilesNeverCrash) {
  std::ostringstream example;
  example << std::ifstream(WIREPOSE_EXAMPLE_CONFIG).rdbuf();
  const std::string good = example.str();
  ASSERT_FALSE(good.empty());
  std::mt19937 random(9);
  for (int i = 0; i < 400; ++i) {
    std::string text = good;
    for (unsigned n = 1 + random() % 4; n > 0; --n) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = static_cast<char>(random());
          break;
        case 1:
          text.erase(at, 1 + random() % 20);
          break;
        default:
          text.insert(at, 1, "{}[]:&*!|>'\"#-\t\n%@"[random() % 18]);
      }
    }
    (void)Refusal(text);
  }
}

}  // namespace
}  // namespace wirepose::app
