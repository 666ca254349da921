// The line that goes with a model edge as a whole: against a slow twin, and among distractors.
#include "stages/edge_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;

constexpr int kRange = 8;
constexpr float kThreshold = kGradientOne;

float Between(Random& random, double low, double high) { return static_cast<float>(random.Uniform(low, high)); }

class EdgeLineTest : public ::testing::Test {
 protected:
  void Start(std::size_t samples) {
    edge_->clear();
    edge_->resize(samples);
    for (std::size_t k = 0; k < samples; ++k) (*edge_)[k] = {};
  }
  [[nodiscard]] float Share(std::size_t k) const {
    return edge_->size() > 1 ? static_cast<float>(k) / static_cast<float>(edge_->size() - 1) : 0.0F;
  }
  EdgeLine Find() { return FindEdgeLine(params_, *edge_, kRange, kThreshold); }

  // The votes of a line, peak by peak.
  [[nodiscard]] float VotesOf(const EdgeLine& line) const {
    float sum = 0;
    for (std::size_t k = 0; k < edge_->size(); ++k) {
      const float at = std::floor(line.At(Share(k)) + 0.5F);
      float most = 0;
      for (const EdgePeak& peak : (*edge_)[k].peaks) {
        const float near = 1 - std::abs(peak.offset_px - at) / params_.width_px;
        if (near <= 0) continue;
        const float strength = std::min(std::abs(peak.gradient) / (8 * kThreshold), 1.0F);
        const float vote = (params_.presence + (1 - params_.presence) * strength) * near;
        most = std::max(most, (peak.gradient > 0) == line.brightens ? vote : params_.other_vote * vote);
      }
      sum += most;
    }
    const float away = 0.5F * (std::abs(line.first_px) + std::abs(line.last_px)) / (kRange + 1);
    return sum * (1 - params_.far_loss * away);
  }

  EdgeLineParams params_;
  std::unique_ptr<EdgePeaks> edge_ = std::make_unique<EdgePeaks>();
};

TEST_F(EdgeLineTest, HasTheMostVotes) {
  Random random(1);
  for (int c = 0; c < Cases(500); ++c) {
    Start(static_cast<std::size_t>(random.Uniform(1, 30)));
    for (std::size_t k = 0; k < edge_->size(); ++k) {
      const int count = static_cast<int>(random.Uniform(0, 5));
      for (int i = 0; i < count; ++i) {
        (*edge_)[k].Add({Between(random, -kRange, kRange), Between(random, -12, 12) * kThreshold});
      }
    }
    float most = 0;
    const float turn = edge_->size() < 4 ? 0 : kRange;
    for (float first = -kRange; first <= kRange; first += params_.step_px) {
      for (float last = -kRange; last <= kRange; last += params_.step_px) {
        if (std::abs(first - last) > turn) continue;
        for (const bool brightens : {false, true}) most = std::max(most, VotesOf({first, last, brightens}));
      }
    }
    EXPECT_NEAR(VotesOf(Find()), most, 1e-4F * (1 + most));
  }
}

// A faint edge all along the model's, among peaks at random places that are stronger.
TEST_F(EdgeLineTest, FaintButEverywhereWins) {
  Random random(2);
  int found = 0;
  const int count = Cases(1000);
  for (int c = 0; c < count; ++c) {
    Start(static_cast<std::size_t>(random.Uniform(12, 40)));
    const EdgeLine truth{Between(random, -3, 3), Between(random, -3, 3), random.Uniform(0, 1) < 0.5};
    for (std::size_t k = 0; k < edge_->size(); ++k) {
      if (random.Uniform(0, 1) < 0.85) {
        const float strength = Between(random, 1, 2) * kThreshold;
        const auto noise = static_cast<float>(0.4 * testing::Gaussian(random));
        (*edge_)[k].Add({truth.At(Share(k)) + noise, truth.brightens ? strength : -strength});
      }
      if (random.Uniform(0, 1) < 0.7) {
        const float sign = random.Uniform(0, 1) < 0.5 ? -1 : 1;
        (*edge_)[k].Add({Between(random, -kRange, kRange), sign * Between(random, 4, 12) * kThreshold});
      }
    }
    const EdgeLine line = Find();
    found += std::abs(line.first_px - truth.first_px) < 2.5F && std::abs(line.last_px - truth.last_px) < 2.5F &&
                     line.brightens == truth.brightens
                 ? 1
                 : 0;
  }
  EXPECT_GE(found, count * 97 / 100);
}

// A strong edge along less than half of the model edge does not draw it away from its own.
TEST_F(EdgeLineTest, AStrongPieceDoesNot) {
  Start(20);
  for (std::size_t k = 0; k < 20; ++k) {
    (*edge_)[k].Add({0.5F, 1.5F * kThreshold});
    if (k < 8) (*edge_)[k].Add({5, 12 * kThreshold});
  }
  const EdgeLine line = Find();
  EXPECT_EQ(line.first_px, 0);
  EXPECT_EQ(line.last_px, 0);
  EXPECT_TRUE(line.brightens);
}

TEST_F(EdgeLineTest, NothingToSeeIsNoOffset) {
  for (const std::size_t samples : {0, 1, 30}) {
    Start(samples);
    const EdgeLine line = Find();
    EXPECT_EQ(line.first_px, 0);
    EXPECT_EQ(line.last_px, 0);
  }
}

TEST_F(EdgeLineTest, AFullSampleKeepsTheStrongest) {
  SamplePeaks sample;
  for (int i = 0; i < 12; ++i) {
    sample.Add({static_cast<float>(i), (i % 2 == 0 ? 1.0F : -1.0F) * static_cast<float>(1 + (7 * i) % 12)});
  }
  ASSERT_EQ(sample.peaks.size(), kMaxSamplePeaks);
  for (const EdgePeak& peak : sample.peaks) EXPECT_GT(std::abs(peak.gradient), 3);
}

TEST_F(EdgeLineTest, PeakScoreFallsWithDistanceAndSaturates) {
  const auto score = [](float offset, float strength) { return PeakScore({offset, strength * kThreshold}, 1, 3, kThreshold); };
  EXPECT_GT(score(1, 2), score(2, 2));
  EXPECT_GT(score(1, -3), score(1, 2));
  EXPECT_EQ(score(1, 8), score(1, -20));
  EXPECT_EQ(score(4.5F, 8), 0);
}

}  // namespace
}  // namespace wirepose
