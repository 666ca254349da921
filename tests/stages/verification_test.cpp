// Verification on rendered pairs: the right pose has more evidence than wrong ones, of every kind.
#include "stages/verification.h"

#include <gtest/gtest.h>

#include "rendered_scene.h"

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
    ComputeDisparityMap({}, scene.camera.width, scene.camera.height, scene.left->normalized, scene.right->normalized,
                        *disparity_scratch_, *disparity_);
    GatherEvidence({},
                   {scene.camera, scene.left->map, scene.right->map, scene.left->normalized, scene.right->normalized,
                    scene.left->smooth, scene.right->smooth, *disparity_},
                   *model_, T, *scratch_, evidence);
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
  const Evidence right = Gather(scene, T);
  EXPECT_GT(right.edges, 0);
  EXPECT_GT(right.support, 0.7F);
  EXPECT_GT(right.inside, 0.99F);
  EXPECT_GE(right.supported_edges, 6);
  EXPECT_EQ(right.supported_faces, 3);
  int beaten = 0;
  const int count = Cases(60);
  for (int k = 0; k < count; ++k) {
    const Evidence wrong =
        Gather(scene, testing::Shaken(random, T, random.Uniform(0.1, 0.5), random.Uniform(0.02, 0.08)));
    EXPECT_LT(wrong.edges, right.edges);
    if (wrong.edges + wrong.faces < right.edges + right.faces) ++beaten;
  }
  EXPECT_EQ(beaten, count);
}

// Scaled about the camera centre the edges stay where they are in the left image; only the faces'
// depth tells.
TEST_F(VerificationTest, TexturedFacesVoteForTheRightDepth) {
  Random random(2);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kLabel, 6);
  const float right = Gather(scene, T).faces;
  EXPECT_GT(right, 1);
  for (const double shift : {-0.12, -0.08, 0.08, 0.12, 0.2}) {
    Pose moved = T;
    moved.t *= 1 + shift;
    EXPECT_LT(Gather(scene, moved).faces, right - 1) << shift;
  }
}

TEST_F(VerificationTest, BlankFacesSayLess) {
  Random random(3);
  const Pose T = testing::GoodView(random, *model_);
  const float textured = Gather(Show(T, sim::Texture::kLabel, 7), T).faces;
  const float blank = Gather(Show(T, sim::Texture::kPlain, 7), T).faces;
  EXPECT_LT(blank, textured);
}

// Slid along its own long edges the model's corners lie where the image's edges go on.
TEST_F(VerificationTest, OverrunCornersSpeakAgainst) {
  Random random(4);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kPlain, 8);
  const float right = Gather(scene, T).overrun;
  EXPECT_LT(right, 0.35F);
  for (const double shift : {-0.06, 0.06}) {
    EXPECT_GT(Gather(scene, T * Pose{Matrix3d::Identity(), {shift, 0, 0}}).overrun, right) << shift;
  }
}

// More edges at the model's edges than beside them.
TEST_F(VerificationTest, ContrastWithTheSurroundings) {
  Random random(8);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kLabel, 9);
  EXPECT_GT(Gather(scene, T).contrast, 0.3F);
  double sum = 0;
  const int count = Cases(50);
  for (int k = 0; k < count; ++k) {
    sum += static_cast<double>(
        Gather(scene, testing::Shaken(random, T, random.Uniform(0.15, 1), random.Uniform(0.03, 0.1))).contrast);
  }
  EXPECT_LT(sum / count, 0.2);
}

// Edges of the object itself stand out from what is beside them; those of a wrong pose do not.
TEST_F(VerificationTest, DistinctEdges) {
  Random random(9);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kPlain, 10);
  const float right = Gather(scene, T).distinct;
  EXPECT_GT(right, 0.5F);
  int beaten = 0;
  const int count = Cases(50);
  for (int k = 0; k < count; ++k) {
    const Evidence wrong =
        Gather(scene, testing::Shaken(random, T, random.Uniform(0.15, 1), random.Uniform(0.03, 0.1)));
    EXPECT_TRUE(wrong.distinct >= 0 && wrong.distinct <= 1);
    if (wrong.distinct < right) ++beaten;
  }
  EXPECT_GE(beaten, count - 1);
}

TEST_F(VerificationTest, SurfacesOfTheSceneAgree) {
  Random random(10);
  const Pose T = testing::GoodView(random, *model_);
  const RenderedScene scene = Show(T, sim::Texture::kLabel, 11);
  const SurfaceEvidence right = Gather(scene, T).surface;
  EXPECT_GT(right.on, 0.7F);
  EXPECT_GT(right.drop, 0.3F);
  EXPECT_LT(right.through, 0.1F);
  Pose nearer = T;
  nearer.t *= 0.85;
  EXPECT_GT(Gather(scene, nearer).surface.through, 0.5F);
}

TEST_F(VerificationTest, NothingInTheImagesSpeaksAgainst) {
  Random random(5);
  RenderedScene scene;
  scene.camera = testing::SmallCamera();
  const auto flat = testing::Paint(320, 240, [](int, int) { return 90; });
  scene.left = testing::FindAll(flat);
  scene.right = testing::FindAll(flat);
  const Evidence none = Gather(scene, testing::GoodView(random, *model_));
  EXPECT_LT(none.edges, 0);
  EXPECT_EQ(none.support, 0);
  EXPECT_EQ(none.supported_edges, 0);
  EXPECT_LE(none.faces, 0.01F);
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
  EXPECT_EQ(outside.edges, 0);
  EXPECT_EQ(outside.faces, 0);
  EXPECT_EQ(outside.overrun, 0);
  EXPECT_EQ(outside.inside, 0);
  EXPECT_EQ(outside.visible_px, 0);
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
    EXPECT_TRUE(std::isfinite(e.edges) && std::isfinite(e.faces) && std::isfinite(e.contrast));
    EXPECT_TRUE(e.support >= 0 && e.support <= 1.001F && e.inside >= 0 && e.inside <= 1.001F);
    EXPECT_TRUE(e.overrun >= 0 && e.overrun <= 1);
    EXPECT_LE(e.supported_faces, 6);
    EXPECT_TRUE(e.distinct >= 0 && e.distinct <= 1);
    EXPECT_TRUE(e.surface.on >= 0 && e.surface.on + e.surface.through + e.surface.before <= 1.001F);
  }
}

}  // namespace
}  // namespace wirepose
