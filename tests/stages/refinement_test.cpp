// Refinement on rendered pairs: it must reach the truth from where hypotheses are, and know how
// well.
#include "stages/refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "rendered_scene.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;
using testing::RenderedScene;
using testing::TestModel;

void ExpectCovariance(const Matrix6d& covariance) {
  EXPECT_LT((covariance - covariance.transpose()).norm(), 1e-12);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(covariance);
  EXPECT_GT(solver.eigenvalues().minCoeff(), 0);
  EXPECT_LT(solver.eigenvalues().maxCoeff(), 0.01);  // 0.1 rad, 10 cm
}

// The twist about the model origin that takes the estimate to the truth.
Vector6d TwistBetween(const Pose& estimate, const Pose& truth) {
  const Eigen::AngleAxisd turn(truth.R * estimate.R.transpose());
  Vector6d twist;
  twist << turn.angle() * turn.axis(), truth.t - estimate.t;
  return twist;
}

// From 3 mm and 1 degree, and from 10 mm and 3 degrees: every pose ends within half a pixel of the
// truth. A wrong derivative would stop short or diverge.
TEST(Refinement, ConvergesToTheTruth) {
  Random random(1);
  const TestModel model = testing::Load("parcel_box");
  const auto scratch = std::make_unique<RefineScratch>();
  double sum = 0, nees = 0;
  int count = 0, near = 0, far = 0;
  const int views = std::max(1, Cases(3)), starts = Cases(20);
  for (int v = 0; v < views; ++v) {
    const Pose T = testing::GoodView(random, *model);
    const RenderedScene scene = testing::Render(model->view, T, sim::Texture::kPlain,
                                                10 + static_cast<std::uint64_t>(v), testing::SmallCamera());
    for (int k = 0; k < starts; ++k) {
      RefinedPose close, wide;
      RefinePose({}, {scene.camera, scene.left->smooth, scene.right->smooth}, *model,
                 testing::Shaken(random, T, 0.0175, 0.003), *scratch, close);
      ASSERT_TRUE(close.ok);
      ExpectCovariance(close.covariance);
      const double error = testing::PixelError(scene.camera, *model, close.T_camera_model, T);
      near += error < 0.5 ? 1 : 0;
      sum += error;
      ++count;
      const Vector6d twist = TwistBetween(close.T_camera_model, T);
      nees += twist.dot(close.covariance.ldlt().solve(twist));
      RefinePose({}, {scene.camera, scene.left->smooth, scene.right->smooth}, *model,
                 testing::Shaken(random, T, 0.052, 0.01), *scratch, wide);
      far += wide.ok && testing::PixelError(scene.camera, *model, wide.T_camera_model, T) < 0.5 ? 1 : 0;
    }
  }
  printf(
      "%d of %d within 0.5 px from 3 mm / 1 deg, %d from 10 mm / 3 deg; mean error %.3f px, mean "
      "NEES %.1f\n",
      near, count, far, sum / count, nees / count);
  EXPECT_EQ(near, count);
  EXPECT_GE(far, 0.85 * count);
  EXPECT_LT(nees / count, 30);  // 6 is right; an overconfident covariance shows as hundreds
}

// Where the model's edges already lie on the image's edges nothing may move: a bias would.
TEST(Refinement, TruthIsAFixedPoint) {
  Random random(2);
  const TestModel model = testing::Load("parcel_box");
  const auto scratch = std::make_unique<RefineScratch>();
  const Pose T = testing::GoodView(random, *model);
  const RenderedScene scene = testing::Render(model->view, T, sim::Texture::kPlain, 3, testing::SmallCamera());
  RefinedPose out;
  RefinePose({}, {scene.camera, scene.left->smooth, scene.right->smooth}, *model, T, *scratch, out);
  ASSERT_TRUE(out.ok);
  EXPECT_LT(testing::PixelError(scene.camera, *model, out.T_camera_model, T), 0.3);
  EXPECT_LT((out.T_camera_model.t - T.t).norm(), 0.004);
  EXPECT_LT(out.rms_px, 1);
  EXPECT_GT(out.inliers, 50);
}

// Each component of the twist is corrected on its own: the columns of the Jacobian one by one.
TEST(Refinement, CorrectsEveryDegreeOfFreedom) {
  Random random(3);
  const TestModel model = testing::Load("parcel_box");
  const auto scratch = std::make_unique<RefineScratch>();
  const Pose T = testing::GoodView(random, *model);
  const RenderedScene scene = testing::Render(model->view, T, sim::Texture::kPlain, 4, testing::SmallCamera());
  for (int i = 0; i < 6; ++i) {
    for (const double sign : {1.0, -1.0}) {
      const Vector6d twist = sign * (i < 3 ? 0.03 : 0.008) * Vector6d::Unit(i);
      RefinedPose out;
      RefinePose({}, {scene.camera, scene.left->smooth, scene.right->smooth}, *model, PerturbLeft(T, twist, T.t),
                 *scratch, out);
      ASSERT_TRUE(out.ok) << i;
      const Vector6d left = TwistBetween(out.T_camera_model, T);
      EXPECT_LT(std::abs(left(i)), 0.35 * std::abs(twist(i))) << i;
    }
  }
}

TEST(Refinement, DegenerateInputsAreNotOk) {
  Random random(5);
  const TestModel model = testing::Load("parcel_box");
  const auto scratch = std::make_unique<RefineScratch>();
  const RectifiedCamera camera = testing::SmallCamera();
  const auto flat = std::make_unique<SmoothPlane>();
  flat->fill(100 * kSmoothOne);
  const Pose T = testing::GoodView(random, *model);
  RefinedPose out;
  const auto refused = [&](const SmoothPlane& image, const Pose& start) {
    RefinePose({}, {camera, image, image}, *model, start, *scratch, out);
    return !out.ok;
  };
  EXPECT_TRUE(refused(*flat, T));
  const auto noise = testing::FindAll(testing::Paint(320, 240, [&](int, int) { return random.Uniform(0, 255); }));
  EXPECT_TRUE(refused(noise->smooth, {T.R, {0, 0, -1}}));    // behind the camera
  EXPECT_TRUE(refused(noise->smooth, {T.R, {50, 0, 1}}));    // far outside of the image
  EXPECT_TRUE(refused(noise->smooth, {T.R, {0, 0, 1000}}));  // a dot
  // One straight edge fixes two degrees of freedom, not six. Damping may still give a pose; never
  // numbers that are none.
  const auto edge = testing::FindAll(testing::Paint(320, 240, [](int x, int) { return x < 160 ? 60 : 160; }));
  for (int k = 0; k < Cases(50); ++k) {
    RefinePose({}, {camera, edge->smooth, edge->smooth}, *model, testing::Shaken(random, T, 0.3, 0.1), *scratch, out);
    EXPECT_TRUE(out.T_camera_model.R.allFinite() && out.T_camera_model.t.allFinite() && out.covariance.allFinite());
  }
}

}  // namespace
}  // namespace wirepose
