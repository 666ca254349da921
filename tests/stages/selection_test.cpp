// Selection: score, order, exclusive ownership, duplicates, overflow.
#include "stages/selection.h"

#include <gtest/gtest.h>

#include "rendered_scene.h"

namespace wirepose {
namespace {

using testing::Random;
using testing::TestModel;

class SelectionTest : public ::testing::Test {
 protected:
  SelectionTest() {
    models_ = std::make_unique<FixedVector<PreparedModel, 2>>();
    models_->push_back(*box_.prepared);
    models_->push_back(*book_.prepared);
    map_ = std::make_unique<EdgeMap>();
    map_->width = 640;
    map_->height = 480;
    map_->directions.fill(0xFFFF);  // everything is supported
  }

  // A candidate with the given centre.
  static Candidate At(std::uint16_t model, double x, double y, double z, float score) {
    static std::uint16_t order = 0;
    Candidate c;
    c.model = model;
    c.order = order++;
    c.pose.T_camera_model.R = ExpSo3({0.5, 0.4, 0});
    c.pose.T_camera_model.t = {x, y, z};
    c.score = score;
    return c;
  }

  std::vector<int> Select(const std::vector<Candidate>& candidates, const SelectParams& params = {}) {
    const auto scratch = std::make_unique<VerifyScratch>();
    const auto claims = std::make_unique<ClaimMap>();
    FixedVector<std::uint16_t, kMaxDetections> accepted;
    SelectDetections(params, testing::TestCamera(), *map_, {models_->begin(), models_->end()}, candidates, *scratch,
                     *claims, accepted, dropped_);
    return {accepted.begin(), accepted.end()};
  }

  TestModel box_ = testing::Load("parcel_box"), book_ = testing::Load("book");
  std::unique_ptr<FixedVector<PreparedModel, 2>> models_;
  std::unique_ptr<EdgeMap> map_;
  std::uint32_t dropped_ = 0;
};

TEST_F(SelectionTest, BestFirstAndNoneBelowTheLimit) {
  EXPECT_EQ(Select({At(0, -0.5, 0, 2, 0.9F), At(1, 0.5, 0, 2, 0.7F), At(0, 0, 0.5, 2, 0.49F)}), (std::vector{0, 1}));
  EXPECT_EQ(Select({}), std::vector<int>{});
  EXPECT_EQ(Select({At(0, 0, 0, 2, 0.2F)}), std::vector<int>{});
}

// Two poses of one object at one place are one object; symmetric ones too.
TEST_F(SelectionTest, DuplicatesMerge) {
  Candidate moved = At(0, 0.02, 0.01, 2, 0.8F), turned = At(0, 0, 0, 2, 0.7F);
  turned.pose.T_camera_model = turned.pose.T_camera_model * models_->front().symmetries[1];
  EXPECT_EQ(Select({At(0, 0, 0, 2, 0.9F), moved, turned, At(0, 0.6, 0, 2, 0.68F)}), (std::vector{0, 3}));
}

// Edges that explain one object cannot explain another one at the same place.
TEST_F(SelectionTest, ImageEdgesHaveOneOwner) {
  // Another model in the same pixels: all of its support belongs to the box when every pixel is
  // claimed.
  SelectParams all;
  all.max_claimed = 0;
  const std::vector<Candidate> overlapping = {At(0, 0, 0, 1.2, 0.9F), At(1, 0.03, 0, 1.2, 0.8F)};
  EXPECT_EQ(Select(overlapping, all), std::vector{0});
  all.max_claimed = 1;
  EXPECT_EQ(Select(overlapping, all), (std::vector{0, 1}));
}

// An occluded edge's pixels are free for others: what is not supported is not owned.
TEST_F(SelectionTest, UnsupportedEdgesClaimNothing) {
  map_->directions.fill(0);
  SelectParams strict;
  strict.max_claimed = 0;
  EXPECT_EQ(Select({At(0, 0, 0, 1.2, 0.9F), At(1, 0.03, 0, 1.2, 0.8F)}, strict), (std::vector{0, 1}));
}

TEST_F(SelectionTest, OverflowKeepsTheBestAndCounts) {
  std::vector<Candidate> candidates;
  for (int i = 0; i < 20; ++i)
    candidates.push_back(At(1, -2.2 + 1.1 * (i % 5), -1.5 + i / 5 * 1.0, 5, 0.99F - 0.01F * static_cast<float>(i)));
  const std::vector<int> accepted = Select(candidates);
  ASSERT_EQ(accepted.size(), kMaxDetections);
  for (std::size_t i = 0; i < accepted.size(); ++i) EXPECT_EQ(accepted[i], static_cast<int>(i));
  EXPECT_EQ(dropped_, 4U);
}

TEST(Order, IsStrictAndTotal) {
  Candidate a, b;
  a.score = 0.9F;
  b.score = 0.8F;
  EXPECT_TRUE(BetterCandidate{}(a, b));
  EXPECT_FALSE(BetterCandidate{}(b, a));
  EXPECT_FALSE(BetterCandidate{}(a, a));
  b.score = a.score;
  b.model = 1;
  EXPECT_TRUE(BetterCandidate{}(a, b));
  b.model = 0;
  b.order = 1;
  EXPECT_TRUE(BetterCandidate{}(a, b));
}

}  // namespace
}  // namespace wirepose
