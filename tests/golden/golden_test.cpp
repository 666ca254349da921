// Intermediates of three recorded frames, compared to the letter. When a stage is changed on
// purpose, regenerate and read the diff:
//   WIREPOSE_UPDATE_GOLDEN=1 build/host-release/bin/golden_test && git diff tests/golden
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "golden_frames.h"
#include "tests/pipeline/recognizer_dump.h"

namespace wirepose {
namespace {

using testing::kGoldenFolder;

bool Updating() {
  const char* flag = std::getenv("WIREPOSE_UPDATE_GOLDEN");
  return flag != nullptr && std::string(flag) == "1";
}

// Models, and frames that are missing. Existing frames are never rendered anew: everything else
// refers to them.
void MakeInputs() {
  const auto targets = sim::LoadTargetMeshes(WIREPOSE_MODELS);
  ASSERT_TRUE(targets);
  std::vector<sim::TargetMesh> wanted;
  for (std::uint32_t id = 1; id <= 3; ++id) {
    const std::string name = testing::kGoldenModels[id - 1];
    tools::CompileOptions options;
    options.id = id;
    const auto model = tools::CompileModel(std::filesystem::path(WIREPOSE_MODELS) / (name + ".ply"), options);
    ASSERT_TRUE(model && tools::WriteModelFile(kGoldenFolder / (name + ".wpm"), *model));
    wanted.push_back((*targets)[id - 1]);
  }
  for (int i = 0; i < testing::kGoldenFrames; ++i) {
    const std::string stem = "frame" + std::to_string(i);
    if (std::filesystem::exists(kGoldenFolder / (stem + "_left.png"))) continue;
    sim::ScenarioSpec spec;
    spec.seed = 101;
    spec.camera.calibration = testing::GoldenCalibration();
    const auto video = sim::ScenarioVideo::Create(spec, i, wanted);
    ASSERT_TRUE(video);
    const sim::StereoShot shot = video->Shoot(0);
    ASSERT_TRUE(dataset::WriteGrayPng(kGoldenFolder / (stem + "_left.png"), shot.left.view()));
    ASSERT_TRUE(dataset::WriteGrayPng(kGoldenFolder / (stem + "_right.png"), shot.right.view()));
  }
}

void Compare(const std::string& name, const std::string& text) {
  const auto file = kGoldenFolder / (name + ".txt");
  if (Updating()) {
    std::ofstream(file) << text;
    return;
  }
  std::ifstream in(file);
  ASSERT_TRUE(in) << file << " is missing; run golden_test with WIREPOSE_UPDATE_GOLDEN=1";
  std::istringstream now(text);
  std::string expected, actual;
  for (int line = 1;; ++line) {
    const bool more = static_cast<bool>(std::getline(in, expected));
    const bool more_now = static_cast<bool>(std::getline(now, actual));
    ASSERT_EQ(more, more_now) << file << ":" << line << ": one of the two ends here";
    if (!more) return;
    ASSERT_EQ(expected, actual) << file << ":" << line
                                << " differs; if on purpose, run golden_test with WIREPOSE_UPDATE_GOLDEN=1";
  }
}

class Golden : public ::testing::TestWithParam<int> {
 protected:
  static void SetUpTestSuite() {
    if (Updating()) MakeInputs();
  }
};

TEST_P(Golden, IntermediatesAreUnchanged) {
  static Recognizer recognizer;
  ASSERT_EQ(recognizer.Configure(testing::GoldenCalibration()), RecognizerError::kOk);
  recognizer.ClearModels();
  const auto models = testing::GoldenModels();
  for (const auto& model : models) ASSERT_EQ(recognizer.AddModel(model.View()), RecognizerError::kOk);
  const testing::StereoImages images = testing::GoldenFrame(GetParam());
  static RecognitionResult result;
  ASSERT_EQ(recognizer.Process(images.left.view(), images.right.view(), nullptr, result), RecognizerError::kOk);
  testing::RecognizerDump dump(testing::Digits::kReadable);
  const std::string stem = "frame" + std::to_string(GetParam());
  Compare(stem + "_segments", dump.Segments("left: a, b, contrast", recognizer.left_segments()));
  Compare(stem + "_lines", dump.Lines(recognizer.lines()));
  Compare(stem + "_detections", dump.Detections(recognizer, result));
}

INSTANTIATE_TEST_SUITE_P(Frames, Golden, ::testing::Range(0, testing::kGoldenFrames));

}  // namespace
}  // namespace wirepose
