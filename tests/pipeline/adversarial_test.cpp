// Bounded time: frames made to be expensive cost little more than a kitchen, overflow with a count, and a search that
// stops at its budget says so.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>

#include "adversarial_frames.h"
#include "pipeline/recognizer.h"
#include "tests/golden/golden_frames.h"

namespace wirepose {
namespace {

class Adversarial : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { models_ = new auto(testing::GoldenModels()); }

  void SetUp() override { Configure({}); }

  static void Configure(const RecognizerParams& params) {
    recognizer_.ClearModels();
    ASSERT_EQ(recognizer_.Configure(testing::GoldenCalibration(), params), RecognizerError::kOk);
    for (const auto& model : *models_) ASSERT_EQ(recognizer_.AddModel(model.View()), RecognizerError::kOk);
  }

  // Processor seconds of this thread, the least of two runs: what another process takes away counts little.
  static double Time(ImageView left, ImageView right) {
    double least = 1e9;
    for (int run = 0; run < 2; ++run) {
      const double begin = Now();
      EXPECT_EQ(recognizer_.Process(left, right, nullptr, result_), RecognizerError::kOk);
      least = std::min(least, Now() - begin);
    }
    return least;
  }

  static double Now() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  static Recognizer recognizer_;
  static RecognitionResult result_;
  static std::vector<tools::CompiledModel>* models_;
};
Recognizer Adversarial::recognizer_;
RecognitionResult Adversarial::result_;
std::vector<tools::CompiledModel>* Adversarial::models_ = nullptr;

// 78 frames: the slowest of them is their p99.9.
TEST_F(Adversarial, NoFrameTakesThreeTimesAKitchen) {
  std::vector<double> kitchens;
  for (int i = 0; i < testing::kGoldenFrames; ++i) {
    const testing::StereoImages frame = testing::GoldenFrame(i);
    kitchens.push_back(Time(frame.left.view(), frame.right.view()));
  }
  std::sort(kitchens.begin(), kitchens.end());
  const double median = kitchens[kitchens.size() / 2];
  double slowest = 0;
  for (const auto& frames : {testing::Gratings(), testing::Boards(), testing::Clutter()}) {
    for (const testing::AdversarialFrame& frame : frames) {
      const double time = Time(frame.left.view(), frame.right.view());
      slowest = std::max(slowest, time);
      EXPECT_LT(time, 3 * median) << frame.name;
      for (const RecognitionList& named : kRecognitionLists) {
        const ListUse& list = result_.statistics.*named.use;
        EXPECT_LE(list.used, list.capacity) << frame.name;
        EXPECT_TRUE(list.dropped == 0 || list.used > 0) << frame.name;
      }
    }
  }
  std::printf("slowest adversarial frame: %.2f times the median kitchen of %.1f ms\n", slowest / median, 1e3 * median);
}

TEST_F(Adversarial, KitchensStayBelowTheBudgets) {
  for (int i = 0; i < testing::kGoldenFrames; ++i) {
    const testing::StereoImages frame = testing::GoldenFrame(i);
    (void)Time(frame.left.view(), frame.right.view());
    EXPECT_FALSE(result_.budget_hit) << "frame " << i;
  }
}

TEST_F(Adversarial, ASearchThatStopsSaysSoAndGivesWhatItFound) {
  const testing::StereoImages frame = testing::GoldenFrame(0);
  RecognizerParams few_pairs;
  few_pairs.correspondences.max_steps = 3000;
  Configure(few_pairs);
  (void)Time(frame.left.view(), frame.right.view());
  EXPECT_TRUE(result_.budget_hit);
  EXPECT_GT(result_.statistics.correspondences.used, 0U) << "the longest lines were searched";

  RecognizerParams few_poses;
  few_poses.hypotheses.max_steps = 50;
  Configure(few_poses);
  (void)Time(frame.left.view(), frame.right.view());
  EXPECT_TRUE(result_.budget_hit);
  EXPECT_GT(result_.statistics.hypotheses.used, 0U);
  EXPECT_LE(result_.statistics.hypotheses.used, 50U);

  RecognizerParams nothing;
  nothing.correspondences.max_steps = 0;
  Configure(nothing);
  (void)Time(frame.left.view(), frame.right.view());
  EXPECT_TRUE(result_.budget_hit);
  EXPECT_EQ(result_.detections.size(), 0U);
}

}  // namespace
}  // namespace wirepose
