// Promotion: alignment of a pose to all lines that agree with it, ranking, and poses that are one.
#include "stages/promotion.h"

#include <gtest/gtest.h>

#include <memory>

#include "rendered_scene.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;
using testing::TestModel;

Hypothesis HypothesisOf(const Pose& T, float score = 1) {
  Hypothesis h;
  h.R = T.R.cast<float>();
  h.t = T.t.cast<float>();
  h.score = score;
  return h;
}

Pose PoseOf(const CorrespondingSet& set) { return {set.R.cast<double>(), set.t.cast<double>()}; }

// A model at any pose, with the lines and edges that both eyes see of it.
class View {
 public:
  View(Random& random, const TestModel& model)
      : T(testing::AnyView(random, *model, testing::TestCamera(), 300)),
        scene(testing::MakeScene(random, *model, T)),
        model_(*model),
        edges_{scene->camera, scene->left, scene->right},
        scorer_(params_, edges_, model_) {}

  std::uint32_t Promote(std::span<const Hypothesis> hypotheses, CorrespondingSets& sets) const {
    return PromoteSets({}, scorer_, scene->camera, model_, scene->lines, hypotheses, sets);
  }

  const Pose T;
  const std::unique_ptr<testing::IdealScene> scene;

 private:
  const PreparedModel& model_;
  const PoseScoreParams params_;
  const SceneEdges edges_;
  const PoseScorer scorer_;
};

bool Same(const PreparedModel& model, const Pose& p, const Pose& q, double tolerance) {
  return IsSamePose(model, p.R.cast<float>(), p.t.cast<float>(), q.R.cast<float>(), q.t.cast<float>(),
                    static_cast<float>(tolerance));
}

void ExpectSameAsCorners(const PreparedModel& model) {
  Random random(1);
  int same = 0;
  for (int k = 0; k < Cases(2000); ++k) {
    const Pose p = testing::AnyView(random, model, testing::TestCamera(), 300);
    const Pose& symmetry =
        model.symmetries[static_cast<std::size_t>(random.Below(static_cast<int>(model.symmetries.size())))];
    const Pose q = testing::Shaken(random, p * symmetry, random.Uniform(0, 0.1), random.Uniform(0, 0.02));
    const double error = testing::CornerError(model, p, q);
    if (std::abs(error - 0.02) < 1e-5) continue;
    ASSERT_EQ(Same(model, p, q, 0.02), error < 0.02) << error;
    same += error < 0.02 ? 1 : 0;
  }
  EXPECT_GT(same, Cases(200));
  EXPECT_LT(same, Cases(1800));
}

TEST(SamePose, AgreesWithCornersModuloSymmetry) {
  for (const char* name : {"parcel_box", "juice_dispenser"}) ExpectSameAsCorners(*testing::Load(name));
}

// The middle of the bounding box of a prism with three equal sides is not on its axis: turns move it.
TEST(SamePose, AgreesWithCornersWhereSymmetriesMoveTheCentre) {
  const TestModel box = testing::Load("parcel_box");
  const auto model = std::make_unique<PreparedModel>(*box);
  const Matrix3d third = ExpSo3({0, 0, 2 * M_PI / 3});
  const Vector3d axis = model->centre.cast<double>() + Vector3d(0.03, 0.02, 0);
  model->symmetries.clear();
  for (const Matrix3d& R : {Matrix3d(Matrix3d::Identity()), third, Matrix3d(third.transpose())}) {
    model->symmetries.push_back({R, axis - R * axis});
    const Vector3d moved = model->symmetries.back() * model->centre.cast<double>() - model->centre.cast<double>();
    model->max_centre_shift_m = std::max(model->max_centre_shift_m, static_cast<float>(moved.norm()));
  }
  ASSERT_GT(model->max_centre_shift_m, 0.03F);
  ExpectSameAsCorners(*model);
}

TEST(SamePose, HalfTurnOfTheDispenserIsAnotherPose) {
  const TestModel model = testing::Load("juice_dispenser");
  ASSERT_EQ(model->symmetries.size(), 1U);
  const Pose p{Matrix3d::Identity(), {0, 0, 1}};
  EXPECT_FALSE(Same(*model, p, p * Pose{ExpSo3({0, 0, M_PI}), Vector3d::Zero()}, 0.02));
}

// Alignment brings a shaken pose closer to the truth, and the set holds the lines that belong to
// the object.
TEST(Promotion, AlignsToAllLines) {
  Random random(2);
  for (const char* name : {"parcel_box", "juice_dispenser"}) {
    const TestModel model = testing::Load(name);
    const auto sets = std::make_unique<CorrespondingSets>();
    int promoted = 0, closer = 0, members = 0, true_members = 0;
    double before = 0, after = 0;
    for (int k = 0; k < Cases(40); ++k) {
      const View view(random, model);
      const Pose& T = view.T;
      const Hypothesis h = HypothesisOf(testing::Shaken(random, T, 0.02, 0.006));
      (void)view.Promote({&h, 1}, *sets);
      if (sets->empty()) continue;
      ++promoted;
      const CorrespondingSet& set = sets->front();
      const double error_before = testing::CornerError(*model, {h.R.cast<double>(), h.t.cast<double>()}, T);
      const double error_after = testing::CornerError(*model, PoseOf(set), T);
      before += error_before;
      after += error_after;
      closer += error_after < error_before ? 1 : 0;
      EXPECT_LE(set.members.size(), set.line_count);
      for (const SetMember& member : set.members) {
        ASSERT_LT(member.line, view.scene->lines.size());
        ++members;
        true_members += view.scene->edge_of_line[member.line] == member.edge ? 1 : 0;
      }
    }
    printf("%s: %d promoted, %d closer, mean error %.2f -> %.2f mm, %d of %d members right\n", name, promoted, closer,
           1e3 * before / promoted, 1e3 * after / promoted, true_members, members);
    EXPECT_GE(promoted, 0.9 * Cases(40));
    EXPECT_GE(closer, 0.85 * promoted);
    EXPECT_LT(after, 0.5 * before);
    EXPECT_GE(true_members, 0.75 * members);
  }
}

// The truth among wrong poses: it comes first, ranks fall, no pose comes twice.
TEST(Promotion, RanksTheTruthFirst) {
  Random random(3);
  const TestModel model = testing::Load("parcel_box");
  const auto sets = std::make_unique<CorrespondingSets>();
  int first = 0;
  const int count = Cases(20);
  for (int k = 0; k < count; ++k) {
    const View view(random, model);
    const Pose& T = view.T;
    std::vector<Hypothesis> hypotheses;
    for (int i = 0; i < 10; ++i)
      hypotheses.push_back(HypothesisOf(testing::Shaken(random, T, 0.3, 0.05), static_cast<float>(30 - i)));
    hypotheses.push_back(HypothesisOf(testing::Shaken(random, T, 0.01, 0.003), 14));
    hypotheses.push_back(HypothesisOf(testing::Shaken(random, T, 0.01, 0.003), 13));
    EXPECT_EQ(view.Promote(hypotheses, *sets), 0U);
    ASSERT_FALSE(sets->empty());
    const double tolerance = static_cast<double>(PromotionParams{}.duplicate_share * model->view.diameter_m);
    float merged = 0;
    for (std::size_t i = 0; i < sets->size(); ++i) {
      const CorrespondingSet& set = (*sets)[i];
      if (i > 0) {
        EXPECT_LE(set.rank, (*sets)[i - 1].rank);
      }
      EXPECT_LE(set.face_count, 3);
      EXPECT_LE(set.line_count, 9);
      EXPECT_NEAR(
          set.strength,
          set.score + PromotionParams{}.line_gain * set.line_count + PromotionParams{}.face_gain * set.face_count,
          1e-3F);
      merged += set.evidence.hypotheses;
      for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(Same(*model, PoseOf(set), PoseOf((*sets)[j]), tolerance));
    }
    EXPECT_LE(merged, static_cast<float>(hypotheses.size()));
    if (testing::CornerError(*model, PoseOf(sets->front()), T) < 0.02) ++first;
  }
  EXPECT_GE(first, 0.9 * count);
}

// The evidence of sets at the truth against that of sets at the same object moved away.
TEST(Promotion, EvidenceSpeaksForTheTruth) {
  Random random(5);
  const TestModel model = testing::Load("parcel_box");
  const auto sets = std::make_unique<CorrespondingSets>();
  SetEvidence right, wrong;
  int rights = 0, wrongs = 0;
  for (int k = 0; k < Cases(40); ++k) {
    const View view(random, model);
    const Pose& T = view.T;
    std::vector<Hypothesis> hypotheses = {HypothesisOf(testing::Shaken(random, T, 0.003, 0.001), 20)};
    for (int i = 0; i < 30; ++i) hypotheses.push_back(HypothesisOf(testing::Shaken(random, T, 0.1, 0.04), 10));
    EXPECT_EQ(view.Promote(hypotheses, *sets), 0U);
    for (const CorrespondingSet& set : *sets) {
      const bool is_right = testing::CornerError(*model, PoseOf(set), T) < 0.015;
      ++(is_right ? rights : wrongs);
      SetEvidence& sum = is_right ? right : wrong;
      sum.left += set.evidence.left;
      sum.right += set.evidence.right;
      sum.lines += set.evidence.lines / set.evidence.edges;
      sum.depth_share += set.evidence.depth_share;
      sum.score_share += set.evidence.score_share;
      EXPECT_GE(set.evidence.overrun, 0);
      EXPECT_LE(set.evidence.overrun, 1);
      EXPECT_LT(set.evidence.residual_px, PromotionParams{}.max_offset_px);
    }
  }
  ASSERT_GE(rights, Cases(20));
  ASSERT_GE(wrongs, Cases(10));
  const auto speaks = [&](float SetEvidence::*term) {
    return right.*term / static_cast<float>(rights) > wrong.*term / static_cast<float>(wrongs);
  };
  EXPECT_TRUE(speaks(&SetEvidence::left));
  EXPECT_TRUE(speaks(&SetEvidence::right));
  EXPECT_TRUE(speaks(&SetEvidence::lines));
  EXPECT_TRUE(speaks(&SetEvidence::depth_share));
  EXPECT_TRUE(speaks(&SetEvidence::score_share));
}

// What is adjusted is the head of the list: no more than fit, none that is too improbable.
TEST(Promotion, WorthRefiningIsTheHeadOfTheList) {
  const auto sets = std::make_unique<CorrespondingSets>();
  const auto worth = [&](float min_rank) {
    PromotionParams params;
    params.min_rank = min_rank;
    return WorthRefining(params, *sets).size();
  };
  EXPECT_EQ(worth(0), 0U);
  for (std::size_t i = 0; i < kMaxPromoted; ++i) {
    CorrespondingSet set;
    set.rank = 1 / static_cast<float>(i + 1);
    sets->push_back(set);
  }
  EXPECT_EQ(worth(0), kMaxRefined);
  EXPECT_EQ(worth(1.0F / 3), 3U);
  EXPECT_EQ(worth(0.4F), 2U);
  EXPECT_EQ(worth(2), 0U);
}

// More poses than there is room for: the first ones are promoted, each other hypothesis is counted, copies are not.
TEST(Promotion, CountsThePosesBeyondItsRoom) {
  Random random(6);
  const TestModel model = testing::Load("parcel_box");
  const View view(random, model);
  std::vector<Hypothesis> hypotheses(kMaxPromoted - 1, HypothesisOf(view.T, 20));
  for (std::size_t i = 1; i < hypotheses.size(); ++i) {
    Pose away = view.T;
    away.t.x() += 0.1 * static_cast<double>(i);
    hypotheses[i] = HypothesisOf(away, 20);
  }
  const auto sets = std::make_unique<CorrespondingSets>();
  EXPECT_EQ(view.Promote(hypotheses, *sets), 0U);
  Pose below = view.T;
  for (int i = 0; i < 4; ++i) {
    below.t.y() += 0.1;
    hypotheses.push_back(HypothesisOf(below, 20));
    EXPECT_EQ(view.Promote(hypotheses, *sets), static_cast<std::uint32_t>(i));
    hypotheses.push_back(HypothesisOf(view.T, 20));
  }
  ASSERT_FALSE(sets->empty());
  EXPECT_LT(testing::CornerError(*model, PoseOf(sets->front()), view.T), 0.02);
}

TEST(Promotion, NoHypothesesNoSets) {
  Random random(4);
  const TestModel model = testing::Load("parcel_box");
  const auto sets = std::make_unique<CorrespondingSets>();
  EXPECT_EQ(View(random, model).Promote({}, *sets), 0U);
  EXPECT_TRUE(sets->empty());
}

}  // namespace
}  // namespace wirepose
