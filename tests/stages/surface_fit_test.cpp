// Faces drawn onto measured surfaces: the derivative against differences, the pose from exact depth, and what does not
// count.
#include "stages/surface_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "depth_scene.h"
#include "rendered_scene.h"
#include "stages/refinement.h"

namespace wirepose {
namespace {

using testing::DepthImage;
using testing::Random;
using testing::TestModel;

struct Scratch {
  FrontTriangles front;
  EdgeSamples edges;
  SurfaceSamples samples;
  SurfaceRows rows;
};

RectifiedCamera Camera() { return testing::DepthCamera(320, 240, 350); }

std::unique_ptr<DisparityMap> MapOf(const RectifiedCamera& camera, const DepthImage& depth) {
  auto map = std::make_unique<DisparityMap>();
  ShrinkDisparity(*testing::DisparitiesOf(camera, depth), *map);
  return map;
}

void Sample(const RectifiedCamera& camera, const PreparedModel& model, const Pose& T, Scratch& s) {
  SampleVisibleEdges({}, camera, model, T, s.front, s.edges);
  SampleSurface({}, camera, model, T, s.edges, s.front, s.samples);
}

// Samples lie on the face they name, as a ray finds it, and away from edges.
TEST(SurfaceFit, SamplesSeenFacesOnly) {
  Random random(1);
  const RectifiedCamera camera = testing::DepthCamera(640, 480, 525);
  const auto s = std::make_unique<Scratch>();
  for (const char* name : {"parcel_box", "juice_dispenser"}) {
    const TestModel model = testing::Load(name);
    std::size_t checked = 0, wrong = 0;
    for (int k = 0; k < testing::Cases(20); ++k) {
      const Pose T = testing::AnyView(random, *model, camera, random.Uniform(80, 400));
      Sample(camera, *model, T, *s);
      for (const SurfaceSample& sample : s->samples) {
        const ModelFace& face = model->view.faces[sample.face];
        const Vector3d n = T.R * Vector3(face.normal[0], face.normal[1], face.normal[2]).cast<double>();
        const double u = static_cast<double>(sample.pixel.x()), v = static_cast<double>(sample.pixel.y());
        const double on_face = testing::PlaneDepth(camera, n, static_cast<double>(face.offset_m) + n.dot(T.t), u, v);
        const double seen = testing::ModelDepth(camera, model->view, T, u, v);
        ++checked;
        wrong += std::abs(on_face - seen) < 0.004 * seen ? 0U : 1U;
      }
    }
    EXPECT_GT(checked, static_cast<std::size_t>(5 * testing::Cases(20))) << name;
    EXPECT_LE(wrong, checked / 100) << name;
  }
}

// d(residual)/d(twist) by central differences.
TEST(SurfaceFit, DerivativeHasANumericTwin) {
  Random random(2);
  const RectifiedCamera camera = Camera();
  const TestModel model = testing::Load("parcel_box");
  const auto s = std::make_unique<Scratch>();
  const Pose T = testing::GoodView(random, *model);
  const auto map = MapOf(camera, testing::ModelBeforeWall(camera, model->view, T, 1.3));
  Sample(camera, *model, T, *s);
  MeasureSurface({}, camera, *model, T, *map, s->samples, s->rows);
  ASSERT_GT(s->rows.size(), 50U);
  const SurfaceRows rows = s->rows;
  constexpr double kStep = 1e-5;
  SurfaceFitParams all;
  all.max_residual_px = 1e3F;
  for (int i = 0; i < 6; ++i) {
    SurfaceRows plus, minus;
    MeasureSurface(all, camera, *model, PerturbLeft(T, kStep * Vector6d::Unit(i), T.t), *map, s->samples, plus);
    MeasureSurface(all, camera, *model, PerturbLeft(T, -kStep * Vector6d::Unit(i), T.t), *map, s->samples, minus);
    ASSERT_EQ(plus.size(), minus.size());
    MeasureSurface(all, camera, *model, T, *map, s->samples, s->rows);
    ASSERT_EQ(plus.size(), s->rows.size());
    for (std::size_t k = 0; k < plus.size(); ++k) {
      const double numeric = -(plus[k].residual - minus[k].residual) / (2 * kStep);
      EXPECT_NEAR(s->rows[k].J(i), numeric, 1e-4 * s->rows[k].J.norm()) << i << ' ' << k;
    }
  }
  for (const SurfaceRow& row : rows) EXPECT_LT(std::abs(row.residual), 0.1);
}

int FacesWithRows(const SurfaceRows& rows, int least) {
  std::map<int, int> count;
  for (const SurfaceRow& row : rows) ++count[row.face];
  return static_cast<int>(std::count_if(count.begin(), count.end(), [&](const auto& c) { return c.second >= least; }));
}

// Three faces determine a pose; Gauss-Newton on exact depth finds it from 8 mm and 2 degrees. Each face may have a bias
// of its own, so that it gives way slowly: edges are what pulls fast.
TEST(SurfaceFit, ExactDepthAloneGivesThePose) {
  Random random(3);
  const RectifiedCamera camera = Camera();
  const TestModel model = testing::Load("parcel_box");
  const auto s = std::make_unique<Scratch>();
  int determined = 0;
  for (int k = 0; k < testing::Cases(20); ++k) {
    const Pose truth = testing::GoodView(random, *model);
    const auto map = MapOf(camera, testing::ModelBeforeWall(camera, model->view, truth, 1.3));
    Pose T = testing::Shaken(random, truth, 0.035, 0.008);
    for (int i = 0; i < 60; ++i) {
      Sample(camera, *model, T, *s);
      MeasureSurface({}, camera, *model, T, *map, s->samples, s->rows);
      Matrix6d H = Matrix6d::Zero();
      Vector6d g = Vector6d::Zero();
      AddSurface(s->rows, 1, H, g);
      T = PerturbLeft(T, H.ldlt().solve(g), T.t);
    }
    if (FacesWithRows(s->rows, 12) < 3) continue;  // two faces leave a motion along both open
    ++determined;
    EXPECT_LT(testing::CornerError(*model, T, truth), 0.005) << k;
  }
  EXPECT_GT(2 * determined, testing::Cases(20));
}

// Something nearer before the object, and holes: what is of another surface has no say.
TEST(SurfaceFit, OtherSurfacesDoNotPull) {
  Random random(4);
  const RectifiedCamera camera = Camera();
  const TestModel model = testing::Load("parcel_box");
  const auto s = std::make_unique<Scratch>();
  const Pose T = testing::GoodView(random, *model);
  DepthImage depth = testing::ModelBeforeWall(camera, model->view, T, 1.3);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      std::uint16_t& z = depth.pixels[static_cast<std::size_t>(y * 320 + x)];
      if (x > 150 && x < 170) z = 4000;
      if (y > 110 && y < 125) z = 0;
    }
  }
  Sample(camera, *model, T, *s);
  MeasureSurface({}, camera, *model, T, *MapOf(camera, depth), s->samples, s->rows);
  EXPECT_LT(s->rows.size(), s->samples.size());
  ASSERT_GT(s->rows.size(), 20U);
  for (const SurfaceRow& row : s->rows) EXPECT_LT(std::abs(row.residual), 0.25);
}

// One image tells distance by size alone; with its depth, errors shrink and the covariance covers them.
TEST(SurfaceFit, RefinementUsesDepth) {
  Random random(5);
  const RectifiedCamera camera = Camera();
  const TestModel model = testing::Load("parcel_box");
  const auto scratch = std::make_unique<RefineScratch>();
  const Pose truth = testing::GoodView(random, *model);
  const testing::RenderedScene scene = testing::Render(model->view, truth, sim::Texture::kPlain, 6, camera);
  const auto map = MapOf(camera, testing::ModelBeforeWall(camera, model->view, truth, 1.25));
  double edges_only = 0, with_depth = 0, nees = 0;
  const int count = testing::Cases(20);
  for (int k = 0; k < count; ++k) {
    const Pose start = testing::Shaken(random, truth, 0.03, 0.008);
    RefinedPose edges, both;
    RefinePose({}, {camera, scene.left->smooth, scene.right->smooth}, *model, start, *scratch, edges);
    RefinePose({}, {camera, scene.left->smooth, scene.right->smooth, map.get()}, *model, start, *scratch, both);
    ASSERT_TRUE(both.ok);
    EXPECT_LT((both.T_camera_model.t - truth.t).norm(), 0.003) << k;
    with_depth += (both.T_camera_model.t - truth.t).norm() / count;
    edges_only += (edges.T_camera_model.t - truth.t).norm() / count;
    EXPECT_LT(both.covariance(5, 5), edges.covariance(5, 5));
    const Eigen::AngleAxisd turn(truth.R * both.T_camera_model.R.transpose());
    Vector6d twist;
    twist << turn.angle() * turn.axis(), truth.t - both.T_camera_model.t;
    nees += twist.dot(both.covariance.ldlt().solve(twist)) / count;
  }
  printf("mean error %.2f mm by edges of one image, %.2f mm with depth; mean NEES %.1f\n", 1000 * edges_only,
         1000 * with_depth, nees);
  EXPECT_LT(with_depth, edges_only);
  EXPECT_LT(nees, 30);
}

}  // namespace
}  // namespace wirepose
