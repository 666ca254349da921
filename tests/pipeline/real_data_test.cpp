// Recorded pictures of real objects. Their folder: WIREPOSE_REAL_DATA, else ../shared/data beside
// the sources.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tools/evaluation/evaluate.h"

namespace wirepose {
namespace {

namespace fs = std::filesystem;

fs::path DataFolder() {
  const char* folder = std::getenv("WIREPOSE_REAL_DATA");
  return folder != nullptr ? fs::path(folder) : fs::path(WIREPOSE_DEFAULT_REAL_DATA);
}

// Eight pairs of a box of tea among clutter: found means that no vertex is off by more than a tenth
// of the diameter.
TEST(RealData, FindsTheTeaBox) {
  const fs::path folder = DataFolder() / "teabox-stereo";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent; set WIREPOSE_REAL_DATA to the folder of real data";
  evaluation::EvaluationOptions options;
  options.dataset = folder;
  const auto outcome = evaluation::Evaluate(options, {});
  ASSERT_TRUE(outcome) << outcome.error();
  EXPECT_EQ(outcome->frames.size(), 8U);
  EXPECT_EQ(outcome->metrics.total.all.instances, 8);
  EXPECT_GE(outcome->metrics.total.all.hits, 6);
}

// Seven images with depth of a toy cube whose faces show pictures and seams, on a desk full of things.
TEST(RealData, FindsThePictureCubeByItsDepth) {
  const fs::path folder = DataFolder() / "picture-cube-rgbd";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent; set WIREPOSE_REAL_DATA to the folder of real data";
  evaluation::EvaluationOptions options;
  options.dataset = folder;
  const auto outcome = evaluation::Evaluate(options, {});
  ASSERT_TRUE(outcome) << outcome.error();
  EXPECT_EQ(outcome->frames.size(), 7U);
  EXPECT_EQ(outcome->metrics.total.all.instances, 7);
  EXPECT_GE(outcome->metrics.total.all.hits, 6);
  EXPECT_LE(outcome->estimates.size(), 8U) << "false alarms";
}

}  // namespace
}  // namespace wirepose
