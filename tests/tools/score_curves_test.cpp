// Score curve and reliability against cases done by hand, and what each estimate was judged to be.
#include "tools/evaluation/score_curves.h"

#include <gtest/gtest.h>

#include <random>

#include "eval_dataset.h"

namespace wirepose::evaluation {
namespace {

TEST(ScoreCurve, OfNothingIsEmpty) { EXPECT_TRUE(ScoreCurve({}, 3).empty()); }

TEST(ScoreCurve, HasOnePointPerDistinctScore) {
  const auto curve = ScoreCurve({{0.5, false}, {0.9, true}, {0.5, true}, {0.7, false}}, 4);
  ASSERT_EQ(curve.size(), 3U);
  EXPECT_EQ(curve[0].threshold, 0.9);
  EXPECT_EQ(curve[0].precision, 1);
  EXPECT_EQ(curve[0].recall, 0.25);
  EXPECT_EQ(curve[1].precision, 0.5);
  EXPECT_EQ(curve[2].threshold, 0.5);
  EXPECT_EQ(curve[2].precision, 0.5);
  EXPECT_EQ(curve[2].recall, 0.5);
}

TEST(ScoreCurve, WithoutInstancesGivesNoRecall) { EXPECT_EQ(ScoreCurve({{0.5, false}}, 0).at(0).recall, 0); }

TEST(Reliability, OfNothingHasNoError) {
  const Reliability r = MeasureReliability({});
  EXPECT_EQ(r.bins.size(), 10U);
  EXPECT_FALSE(r.expected_error);
}

TEST(Reliability, IsTheWeightedGapOfTheBins) {
  const ScoredDetection detections[] = {{0.95, true}, {1.0, true}, {0.91, false}, {0.52, true}, {0, false}};
  const Reliability r = MeasureReliability(detections);
  EXPECT_EQ(r.bins[9].count, 3) << "1 belongs to the last bin";
  EXPECT_NEAR(r.bins[9].mean_score, 0.95333, 1e-5);
  EXPECT_NEAR(r.bins[9].share_right, 2.0 / 3, 1e-12);
  EXPECT_EQ(r.bins[5].count, 1);
  EXPECT_NEAR(*r.expected_error, (3 * (0.953333 - 0.666667) + 1 * (1 - 0.52) + 0) / 5, 1e-5);
}

TEST(Reliability, IntervalIsWilsons) {
  std::vector<ScoredDetection> detections(10, {0.75, true});
  for (int i = 0; i < 3; ++i) detections[static_cast<std::size_t>(i)].right = false;
  const ReliabilityBin bin = MeasureReliability(detections).bins[7];
  EXPECT_NEAR(bin.share_low, 0.3968, 1e-4);
  EXPECT_NEAR(bin.share_high, 0.8922, 1e-4);
}

TEST(Reliability, OfHonestScoresIsSmall) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<ScoredDetection> honest, boasting;
  for (int i = 0; i < 20000; ++i) {
    const double p = uniform(random);
    honest.push_back({p, uniform(random) < p});
    boasting.push_back({p, uniform(random) < 0.5 * p});
  }
  EXPECT_LT(*MeasureReliability(honest).expected_error, 0.02);
  EXPECT_NEAR(*MeasureReliability(boasting).expected_error, 0.25, 0.02);
}

// Every estimate is judged once, and the judgements add up to the counts.
TEST(Judgements, AddUpToTheCounts) {
  std::mt19937 random(11);
  for (int n = 0; n < 10; ++n) {
    testing::TemporaryFolder folder;
    testing::WriteRandomDataset(folder.path(), random);
    const auto truth = ReadGroundTruth(folder.path());
    ASSERT_TRUE(truth) << truth.error();
    const auto estimates = testing::RandomEstimates(*truth, random);
    const Metrics metrics = ComputeMetrics(*truth, estimates);
    ASSERT_EQ(metrics.judgements.size(), estimates.size());
    const auto count = [&](Verdict v) {
      return static_cast<int>(std::ranges::count(metrics.judgements, v, &Judgement::verdict));
    };
    EXPECT_EQ(count(Verdict::kHit), metrics.total.all.hits);
    EXPECT_EQ(count(Verdict::kFalse), metrics.total.false_positives);
    EXPECT_EQ(count(Verdict::kDontCare), metrics.total.dont_care);
    EXPECT_EQ(static_cast<int>(CountedDetections(estimates, metrics).size()),
              metrics.total.all.hits + metrics.total.false_positives);
    const auto curve = ScoreCurve(CountedDetections(estimates, metrics), metrics.total.all.instances);
    if (!curve.empty()) {
      EXPECT_EQ(curve.back().recall, metrics.total.all.Recall());
      EXPECT_EQ(curve.back().precision, metrics.total.Precision());
    }
  }
}

// An instance's index names the pose that the outcome speaks of.
TEST(Judgements, NameInstancesByTheirPlaceInTheFrame) {
  std::mt19937 random(12);
  testing::TemporaryFolder folder;
  testing::WriteRandomDataset(folder.path(), random);
  const auto truth = ReadGroundTruth(folder.path());
  ASSERT_TRUE(truth) << truth.error();
  const Metrics metrics = ComputeMetrics(*truth, testing::RandomEstimates(*truth, random));
  for (const InstanceOutcome& o : metrics.instances) {
    const auto frame = std::ranges::find_if(
        truth->frames, [&](const FrameTruth& f) { return f.scene_id == o.scene_id && f.image_id == o.image_id; });
    ASSERT_NE(frame, truth->frames.end());
    ASSERT_LT(o.instance, frame->instances.size());
    const InstanceTruth& named = frame->instances[o.instance];
    EXPECT_EQ(named.object_id, o.object_id);
    EXPECT_EQ(named.visible_fraction, o.visible_fraction);
    if (!o.hit) {
      EXPECT_EQ(named.T_camera_model.t_mm, o.truth.t_mm);
    }
  }
}

}  // namespace
}  // namespace wirepose::evaluation
