// Verification on rendered pairs: the right pose has more evidence than wrong ones, of every kind.
#include "stages/verification.h"

#include <gtest/gtest.h>

#include "rendered_scene.h"
#include "stages/edge_summary.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;
using testing::RenderedScene;
using testing::TestModel;

class VerificationTest : public ::testing::Test {
 protected:
  Evidence Gather(const RenderedScene& scene, const Pose& T) {
    Evidence evidence;
    RefinedPose pose;
    pose.T_camera_model = T;
    pose.covariance *= 1e-6;
    ComputeDisparityMap({}, scene.camera.width, scene.camera.height, scene.left->normalized, scene.right->normalized,
                        *disparity_scratch_, *disparity_);
    const auto& segments = scene.left->segments.items;
    GatherEvidence({},
                   {scene.camera,
                    scene.left->map,
                    scene.right->map,
                    scene.left->smooth,
                    scene.right->smooth,
                    *disparity_,
                    {segments.begin(), segments.end()}},
                   *model_, pose, *scratch_, evidence);
    return evidence;
  }
  RenderedScene Show(const Pose& T, sim::Texture texture, std::uint64_t seed) {
    return testing::Render(model_->view, T, texture, seed, testing::SmallCamera());
  }

  TestModel model_ = testing::Load("parcel_box");
  std::unique_ptr<DisparityScratch> disparity_scratch_ = std::make_unique<DisparityScratch>();
  std::unique_ptr<DisparityMap> disparity_ = std::make_unique<DisparityMap>();
  std::unique_ptr<VerifyScratch> scratch_ = std::make_unique<VerifyScratch>();
};

TEST_F(VerificationTest, RightPoseBeatsShiftedOnes) {
  Random random(1);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kLabel, 5);
  const EdgeEvidence right = Gather(scene, T).edges;
  EXPECT_GT(right.support, 0.7F);
  EXPECT_GT(right.sharp, 0.6F);
  EXPECT_GT(right.inside, 0.99F);
  EXPECT_EQ(right.edges, 9);
  EXPECT_GT(right.full_edges, 0.5F);
  EXPECT_LT(right.spread_px, 0.5F);
  for (int k = 0; k < Cases(60); ++k) {
    const EdgeEvidence wrong =
        Gather(scene, testing::Shaken(random, T, random.Uniform(0.1, 0.5), random.Uniform(0.02, 0.08))).edges;
    EXPECT_LT(wrong.support, right.support);
    EXPECT_LT(wrong.sharp, right.sharp - 0.2F);
    EXPECT_LE(wrong.full_edges, right.full_edges);
    EXPECT_LE(wrong.weakest_edge, right.weakest_edge);
    EXPECT_LT(wrong.outline, right.outline);
    EXPECT_LE(wrong.weakest_face, right.weakest_face);
    EXPECT_LE(wrong.ends, right.ends);
    EXPECT_LE(wrong.corners, right.corners);
  }
}

// A box seen on three faces, of which one edge is missing and another held at one end only.
TEST_F(VerificationTest, SummaryCountsEndsCornersAndFaces) {
  Random random(13);
  const Pose T = testing::GoodView(random, *model_);
  const Vector3 eye = -(T.R.transpose() * T.t).cast<float>();
  const ModelView& view = model_->view;
  const auto towards = [&](std::uint16_t face) { return IsTowards(view.faces[face], eye); };
  std::vector<EdgeSums> sums(kMaxModelEdges);
  std::vector<std::size_t> inner;
  for (std::size_t e = 0; e < view.edges.size(); ++e) {
    const ModelEdge& edge = view.edges[e];
    const int count = (towards(edge.face[0]) ? 1 : 0) + (towards(edge.face[1]) ? 1 : 0);
    if (count == 0) continue;
    if (count == 2) inner.push_back(e);
    sums[e].length_px = 100;
    for (int k = 0; k < 10; ++k) sums[e].Add({.left_px = 0, .worst_px = 0.1F}, 0.5F, 0.8F);
  }
  ASSERT_EQ(inner.size(), 3u);
  EdgeEvidence all;
  SummarizeEdges({}, *model_, T, sums, 900, all);
  EXPECT_EQ(all.edges, 9);
  EXPECT_FLOAT_EQ(all.ends, 1);
  EXPECT_FLOAT_EQ(all.corners, 1);
  EXPECT_FLOAT_EQ(all.weakest_face, 1);
  EXPECT_FLOAT_EQ(all.inside, 1);

  EdgeSums missing;
  missing.length_px = 100;
  for (int k = 0; k < 10; ++k) missing.Add(Support{}, 0.5F, 0.8F);
  sums[inner[0]] = missing;
  EdgeSums half;
  half.length_px = 100;
  for (int k = 0; k < 10; ++k) half.Add(k < 5 ? Support{.left_px = 0, .worst_px = 0.1F} : Support{}, 0.5F, 0.8F);
  sums[inner[1]] = half;
  EdgeEvidence less;
  SummarizeEdges({}, *model_, T, sums, 900, less);
  EXPECT_FLOAT_EQ(less.ends, 15.0F / 18);
  // The three inner edges meet in one corner; their other ends are corners of their own.
  const bool half_holds_middle = view.edges[inner[1]].vertex[0] == view.edges[inner[2]].vertex[0] ||
                                 view.edges[inner[1]].vertex[0] == view.edges[inner[2]].vertex[1];
  EXPECT_FLOAT_EQ(less.corners, half_holds_middle ? 4.0F / 7 : 5.0F / 7);
  EXPECT_FLOAT_EQ(less.outline, 1);
  EXPECT_FLOAT_EQ(less.weakest_face, 2.5F / 4);
  EXPECT_FLOAT_EQ(less.weak_edges, 1.0F / 9);
  EXPECT_FLOAT_EQ(less.full_edges, 7.0F / 9);
}

// Support at every offset within 2.2 px counts, sharp support only at the edge itself.
TEST_F(VerificationTest, AShiftedPoseLosesSharpnessFirst) {
  Random random(2);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kPlain, 6);
  Pose moved = T;
  moved.t += Vector3d(1, 1, 0) * 1.2 * T.t.z() / scene.camera.f;
  const EdgeEvidence right = Gather(scene, T).edges, shifted = Gather(scene, moved).edges;
  EXPECT_GT(shifted.support, right.support - 0.15F);
  EXPECT_LT(shifted.sharp, 0.6F * right.sharp);
}

// Slid along its own long edges the model's corners lie where the image's edges go on.
TEST_F(VerificationTest, OverrunCornersSpeakAgainst) {
  Random random(4);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kPlain, 8);
  const Evidence truth = Gather(scene, T);
  const EdgeEvidence& right = truth.edges;
  EXPECT_LT(right.overrun, 0.35F);
  EXPECT_LT(right.crossed, 0.15F);
  EXPECT_LT(truth.lines.beyond, 0.05F);
  for (const double shift : {-0.06, 0.06}) {
    const Evidence slid = Gather(scene, T * Pose{Matrix3d::Identity(), {shift, 0, 0}});
    EXPECT_GT(slid.lines.beyond, 0.1F) << shift;
    EXPECT_GT(slid.edges.overrun, right.overrun) << shift;
    EXPECT_GT(slid.edges.crossed, 0.15F) << shift;  // edges around the end of the box that stands within the true one
  }
}

// More edges at the model's edges than beside them.
TEST_F(VerificationTest, ContrastWithTheSurroundings) {
  Random random(8);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kLabel, 9);
  const auto contrast = [](const Evidence& e) { return e.edges.support - e.edges.chance; };
  EXPECT_GT(contrast(Gather(scene, T)), 0.3F);
  double sum = 0;
  const int count = Cases(50);
  for (int k = 0; k < count; ++k) {
    sum += static_cast<double>(
        contrast(Gather(scene, testing::Shaken(random, T, random.Uniform(0.15, 1), random.Uniform(0.03, 0.1)))));
  }
  EXPECT_LT(sum / count, 0.2);
}

// Edges of the object itself stand out from what is beside them; those of a wrong pose do not.
TEST_F(VerificationTest, DistinctEdges) {
  Random random(9);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kPlain, 10);
  const float right = Gather(scene, T).edges.distinct;
  EXPECT_GT(right, 0.5F);
  int beaten = 0;
  const int count = Cases(50);
  for (int k = 0; k < count; ++k) {
    const EdgeEvidence wrong =
        Gather(scene, testing::Shaken(random, T, random.Uniform(0.15, 1), random.Uniform(0.03, 0.1))).edges;
    EXPECT_TRUE(wrong.distinct >= 0 && wrong.distinct <= 1);
    if (wrong.distinct < right) ++beaten;
  }
  EXPECT_GE(beaten, count - 1);
}

// On average over views: the map is wrong in places, more in one view than in another.
TEST_F(VerificationTest, SurfacesOfTheSceneAgree) {
  Random random(10);
  constexpr int kViews = 10;  // sanitized too: fewer would not be an average
  SurfaceEvidence sum;
  for (int v = 0; v < kViews; ++v) {
    const Pose T = testing::GoodView(random, *model_);
    const RenderedScene scene = Show(T, sim::Texture::kLabel, 11 + static_cast<std::uint64_t>(v));
    const SurfaceEvidence right = Gather(scene, T).surface;
    sum.on += right.on;
    sum.drop += right.drop;
    sum.through += right.through;
    Pose nearer = T;
    nearer.t *= 0.85;
    EXPECT_GT(Gather(scene, nearer).surface.through, 0.5F) << v;
  }
  const auto n = static_cast<float>(kViews);
  EXPECT_GT(sum.on, 0.8F * n);
  EXPECT_GT(sum.drop, 0.3F * n);
  EXPECT_LT(sum.through, 0.1F * n);
}

TEST_F(VerificationTest, NothingInTheImagesSpeaksAgainst) {
  Random random(5);
  RenderedScene scene;
  scene.camera = testing::SmallCamera();
  const auto flat = testing::Paint(320, 240, [](int, int) { return 90; });
  scene.left = testing::FindAll(flat);
  scene.right = testing::FindAll(flat);
  const Evidence none = Gather(scene, testing::GoodView(random, *model_));
  EXPECT_GT(none.edges.visible_px, 100);
  EXPECT_EQ(none.edges.support, 0);
  EXPECT_EQ(none.edges.full_edges, 0);
  EXPECT_EQ(none.edges.clear, 0);
}

// What lies outside of the images abstains.
TEST_F(VerificationTest, OutsideAbstains) {
  Random random(6);
  RenderedScene scene;
  scene.camera = testing::SmallCamera();
  const auto noise = testing::Paint(320, 240, [&](int, int) { return random.Uniform(0, 255); });
  scene.left = testing::FindAll(noise);
  scene.right = testing::FindAll(noise);
  Pose T = testing::GoodView(random, *model_);
  T.t.x() += 3;
  const Evidence outside = Gather(scene, T);
  EXPECT_EQ(outside.edges.edges, 0);
  EXPECT_EQ(outside.edges.support, 0);
  EXPECT_EQ(outside.edges.overrun, 0);
  EXPECT_EQ(outside.edges.crossed, 0);
  EXPECT_EQ(outside.edges.inside, 0);
  EXPECT_EQ(outside.edges.visible_px, 0);
}

// A board before the object's left half: what it hides abstains, what is beside it keeps its support.
TEST_F(VerificationTest, WhatIsHiddenAbstains) {
  Random random(11);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kLabel, 12);
  const Evidence whole = Gather(scene, T);
  EXPECT_LT(whole.hidden, 0.1F);
  const auto cover = static_cast<std::uint16_t>(100 * DisparityMap::kOne);
  float centre = 0;
  for (const EdgeSample& s : scratch_->samples) centre += s.left.x() / static_cast<float>(scratch_->samples.size());
  for (int y = 0; y < disparity_->height; ++y) {
    for (int x = 0; x < static_cast<int>(centre) / DisparityMap::kScale; ++x) {
      disparity_->disparity[static_cast<std::size_t>(y * DisparityMap::kMaxWidth + x)] = cover;
    }
  }
  RenderSurface(scene.camera, *model_, T, scratch_->surface);
  SampleVisibleEdges({}, scene.camera, *model_, T, scratch_->front, scratch_->samples);
  const float hidden = DropOccluded({}, *disparity_, scratch_->surface, scratch_->samples);
  EXPECT_GT(hidden, 0.25F);
  EXPECT_LT(hidden, 0.75F);
  // At acute corners no place beside the edge is the object's: such samples stay.
  int left_over = 0;
  for (const EdgeSample& s : scratch_->samples) left_over += s.left.x() < centre - 12 ? 1 : 0;
  EXPECT_LT(left_over, static_cast<int>(scratch_->samples.size()) / 10);
}

// Any pose at all: numbers stay numbers, shares stay shares.
TEST_F(VerificationTest, AnyPoseGivesFiniteEvidence) {
  Random random(7);
  RenderedScene scene;
  scene.camera = testing::SmallCamera();
  const auto noise = testing::Paint(320, 240, [&](int, int) { return random.Uniform(0, 255); });
  scene.left = testing::FindAll(noise);
  scene.right = testing::FindAll(noise);
  for (int k = 0; k < Cases(300); ++k) {
    const Pose T{testing::AnyRotation(random),
                 Vector3d(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-0.5, 3))};
    const Evidence e = Gather(scene, T);
    for (const float term : TermsOf(e)) EXPECT_TRUE(std::isfinite(term));
    const EdgeEvidence& edges = e.edges;
    for (const float share :
         {edges.inside, edges.support, edges.chance, edges.sharp, edges.sharp_of_support, edges.full_edges,
          edges.weakest_edge, edges.distinct, edges.clear, edges.dimmest_edge, edges.overrun, edges.crossed,
          e.lines.crossing, e.lines.contained, e.hidden, e.surface.on, e.surface.on + e.surface.through}) {
      EXPECT_TRUE(share >= 0 && share <= 1.001F) << share;
    }
  }
}

}  // namespace
}  // namespace wirepose
