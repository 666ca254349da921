// The score: trees against a walk by hand, and what the fitted table must keep to.
#include "stages/score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "stage_test_support.h"
#include "stages/set_rank.h"

namespace wirepose {
namespace {

using testing::Random;

EvidenceTerms AnyTerms(Random& random) {
  EvidenceTerms terms;
  for (std::size_t i = 0; i < kEvidenceTerms; ++i) {
    const std::string name = EvidenceTermNames()[i];
    const double high = name == "visible_px" ? 4000 : name == "disparity_px" ? 150 : name == "edges" ? 60 : 1;
    terms[i] = static_cast<float>(random.Uniform(0, high));
  }
  return terms;
}

TEST(Score, WalksTheTrees) {
  std::array<ScoreTree, 2> trees;
  for (ScoreTree::Split& split : trees[0].splits) split = {0, 1};
  trees[0].splits[2] = {1, 5};
  for (std::size_t i = 0; i < trees[0].leaves.size(); ++i) trees[0].leaves[i] = 0.25F * static_cast<float>(i);
  trees[1].leaves.fill(-2);
  const ScoreTable table{0.5F, trees};
  const auto log_odds = [&](float first, float second) {
    EvidenceTerms terms{};
    terms[0] = first;
    terms[1] = second;
    const double p = static_cast<double>(ScoreOf(table, terms));
    return std::log(p / (1 - p));
  };
  constexpr auto kLast = static_cast<double>(ScoreTree::kSplits);
  EXPECT_NEAR(log_odds(1, 9), 0.5 - 2, 1e-4);                                     // at the threshold: always left
  EXPECT_NEAR(log_odds(2, 6), 0.5 + 0.25 * kLast - 2, 1e-3);                      // always right
  EXPECT_NEAR(log_odds(2, 5), 0.5 + 0.25 * (kLast - (kLast + 1) / 4) - 2, 1e-3);  // left once, at the second split
}

TEST(Score, EmptyTableIsItsBias) {
  EXPECT_EQ(ScoreOf({}, {}), 0.5F);
  EXPECT_NEAR(ScoreOf({-1, {}}, {}), 1 / (1 + std::exp(1.0)), 1e-6);
  EXPECT_LT(ScoreOf({-1e9F, {}}, {}), 1e-6F);
}

void ReadsKnownTermsOnly(const ScoreTable& table, std::size_t terms) {
  ASSERT_FALSE(table.trees.empty());
  for (const ScoreTree& tree : table.trees) {
    for (const ScoreTree::Split& split : tree.splits) EXPECT_LT(split.term, terms);
    for (const float leaf : tree.leaves) EXPECT_TRUE(std::isfinite(leaf));
  }
}

TEST(Score, TablesReadKnownTermsOnly) {
  ReadsKnownTermsOnly(DefaultScoreTable(), kEvidenceTerms);
  ReadsKnownTermsOnly(DefaultRankTable(), kSetTerms);
}

TEST(Score, RankNeverRisesWithOverrun) {
  Random random(2);
  for (int k = 0; k < testing::Cases(2000); ++k) {
    SetEvidence e;
    e.score = static_cast<float>(random.Uniform(0, 120));
    e.score_share = static_cast<float>(random.Uniform(0, 1));
    e.left = static_cast<float>(random.Uniform(0, 1));
    e.right = static_cast<float>(random.Uniform(0, 1));
    e.edges = static_cast<float>(random.Below(80));
    e.lines = static_cast<float>(random.Below(30));
    e.depth_share = static_cast<float>(random.Uniform(0, 1));
    e.residual_px = static_cast<float>(random.Uniform(0, 4));
    e.disparity_misfit = static_cast<float>(random.Uniform(0, 5));
    e.hypotheses = static_cast<float>(random.Below(60));
    e.overrun = static_cast<float>(random.Uniform(0, 1));
    SetEvidence more = e;
    more.overrun = static_cast<float>(random.Uniform(static_cast<double>(e.overrun), 1));
    EXPECT_LE(ScoreOf(DefaultRankTable(), TermsOf(more)), ScoreOf(DefaultRankTable(), TermsOf(e)) + 1e-5F);
  }
}

// What is known of a term's direction is built into the table: more of it never turns the score the other way.
TEST(Score, NeverFallsWithEvidence) {
  Random random(1);
  const auto index = [](const std::string& name) {
    std::size_t i = 0;
    while (i < kEvidenceTerms && name != EvidenceTermNames()[i]) ++i;
    return i;
  };
  const auto check = [&](const std::string& name, bool rises) {
    const std::size_t i = index(name);
    ASSERT_LT(i, kEvidenceTerms) << name;
    for (int k = 0; k < testing::Cases(500); ++k) {
      EvidenceTerms less = AnyTerms(random), more = less;
      more[i] = less[i] * static_cast<float>(1 + random.Uniform(0, 2));
      const float a = ScoreOf(DefaultScoreTable(), less), b = ScoreOf(DefaultScoreTable(), more);
      ASSERT_TRUE(a >= 0 && a <= 1);
      // The leaves are rounded to float, and so is their sum.
      ASSERT_TRUE(rises ? b >= a - 1e-5F : b <= a + 1e-5F) << name << " " << a << " " << b;
    }
  };
  for (const char* name :
       {"visible_px", "inside", "support", "sharp", "full_edges", "distinct", "on", "drop", "stands"}) {
    check(name, true);
  }
  for (const char* name :
       {"chance", "overrun", "crossed", "hidden", "through", "rms_px", "uncertainty", "hangs", "gap"})
    check(name, false);
}

}  // namespace
}  // namespace wirepose
