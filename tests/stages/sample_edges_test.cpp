// Hidden lines against a search through all triangles in double precision.
#include "stages/sample_edges.h"

#include <gtest/gtest.h>

#include "model_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;
using testing::TestModel;

struct Sampling {
  FrontTriangles front;
  EdgeSamples samples;
};

class SamplingTest : public ::testing::TestWithParam<const char*> {};

// Compares one view; `seen_px` and `sampled_px` sum up the length of edges in the image.
void CompareView(const PreparedModel& model, const Pose& T, Sampling& s, double& seen_px, double& sampled_px) {
  const RectifiedCamera camera = testing::TestCamera();
  SampleVisibleEdges({}, camera, model, T, s.front, s.samples);
  const Vector3d eye = T.Inverse().t;
  std::vector<double> length(model.edges.size());
  for (const EdgeSample& sample : s.samples) {
    ASSERT_LT(sample.edge, model.edges.size());
    const PreparedEdge& edge = model.edges[sample.edge];
    const double share = static_cast<double>((sample.point - edge.a).dot(edge.direction) / edge.length_m);
    // A margin of a hundredth leaves out what rounding may decide either way.
    EXPECT_TRUE(testing::SeesEdgePoint(model, sample.edge, share, eye, -0.01));
    const Vector3d u = camera.Project(T * sample.point.cast<double>());
    EXPECT_LT((u.head<2>() - sample.left.cast<double>()).norm(), 0.01);
    EXPECT_NEAR(u.z(), static_cast<double>(sample.disparity), 1e-3);
    length[sample.edge] += static_cast<double>(sample.weight_px);
  }
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    const Vector3d a = camera.Project(T * model.edges[e].a.cast<double>()),
                   b = camera.Project(T * model.edges[e].b.cast<double>());
    const double whole = (b - a).head<2>().norm();
    if (whole < 12) continue;
    constexpr int kSteps = 60;
    int seen = 0;
    for (int k = 0; k < kSteps; ++k) seen += testing::SeesEdgePoint(model, e, (k + 0.5) / kSteps, eye) ? 1 : 0;
    seen_px += whole * seen / kSteps;
    sampled_px += length[e];
    // Perspective puts the steps of the two at different places.
    EXPECT_NEAR(length[e], whole * seen / kSteps, 0.25 * whole + 15) << e;
  }
}

TEST_P(SamplingTest, AgreesWithBruteForce) {
  const TestModel model =
      std::string(GetParam()) == "two_parts" ? testing::Compile(testing::TwoPartMesh()) : testing::Load(GetParam());
  const auto s = std::make_unique<Sampling>();
  Random random(1);
  double seen = 0, sampled = 0;
  for (int k = 0; k < Cases(30); ++k)
    CompareView(*model, testing::AnyView(random, *model, testing::TestCamera(), 350), *s, seen, sampled);
  EXPECT_NEAR(sampled / seen, 1, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Models, SamplingTest, ::testing::Values("parcel_box", "book", "two_parts", "juice_dispenser"),
                         [](const auto& test) { return std::string(test.param); });

// The tangents are those of the projected edge in either image.
TEST(Sampling, TangentsAreNumericDerivatives) {
  const TestModel model = testing::Load("parcel_box");
  const auto s = std::make_unique<Sampling>();
  const RectifiedCamera camera = testing::TestCamera();
  Random random(2);
  const Pose T = testing::AnyView(random, *model, camera, 350);
  SampleVisibleEdges({}, camera, *model, T, s->front, s->samples);
  ASSERT_GT(s->samples.size(), 50U);
  for (const EdgeSample& sample : s->samples) {
    const Vector3d step = 1e-5 * model->edges[sample.edge].direction.cast<double>();
    const Vector3d du = camera.Project(T * (sample.point.cast<double>() + step)) -
                        camera.Project(T * (sample.point.cast<double>() - step));
    EXPECT_GT(du.head<2>().normalized().dot(sample.tangent.cast<double>()), 1 - 1e-5);
    EXPECT_GT(Eigen::Vector2d(du.x() - du.z(), du.y()).normalized().dot(sample.tangent_right.cast<double>()), 1 - 1e-5);
  }
}

// An object that fills the image has more edge than samples: the step widens, no edge is lost.
TEST(Sampling, StepWidensInsteadOfOverflowing) {
  const TestModel model = testing::Load("refrigerator");
  const auto s = std::make_unique<Sampling>();
  Random random(3);
  for (int k = 0; k < Cases(20); ++k) {
    const Pose T = testing::AnyView(random, *model, testing::TestCamera(), 900);
    SampleVisibleEdges({}, testing::TestCamera(), *model, T, s->front, s->samples);
    EXPECT_GT(s->samples.size(), 100U);
    double seen = 0, sampled = 0;
    for (const EdgeSample& sample : s->samples) sampled += static_cast<double>(sample.weight_px);
    for (std::size_t e = 0; e < model->edges.size(); ++e) {
      const Vector3d a = T * model->edges[e].a.cast<double>(), b = T * model->edges[e].b.cast<double>();
      const double length = (testing::TestCamera().Project(b) - testing::TestCamera().Project(a)).head<2>().norm();
      if (length < 8 || a.z() < 0.13 * T.t.z() || b.z() < 0.13 * T.t.z()) continue;
      constexpr int kSteps = 20;
      for (int i = 0; i < kSteps; ++i)
        seen += testing::SeesEdgePoint(*model, e, (i + 0.5) / kSteps, T.Inverse().t) ? length / kSteps : 0;
    }
    EXPECT_NEAR(sampled / seen, 1, 0.1);
  }
}

TEST(Sampling, BehindTheCameraThereIsNothing) {
  const TestModel model = testing::Load("parcel_box");
  const auto s = std::make_unique<Sampling>();
  SampleVisibleEdges({}, testing::TestCamera(), *model, {Matrix3d::Identity(), {0, 0, -1}}, s->front, s->samples);
  EXPECT_TRUE(s->samples.empty());
  // The camera inside the object: nothing that breaks.
  SampleVisibleEdges({}, testing::TestCamera(), *model, {Matrix3d::Identity(), {0, 0, 0.01}}, s->front, s->samples);
  for (const EdgeSample& sample : s->samples) EXPECT_TRUE(sample.left.allFinite());
}

}  // namespace
}  // namespace wirepose
