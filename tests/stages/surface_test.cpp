// The rendered surface against ray casting, and what it says of scenes whose surfaces are known.
#include "stages/surface_evidence.h"

#include <gtest/gtest.h>

#include "model_test_support.h"

namespace wirepose {
namespace {

using testing::Random;
using testing::TestModel;

// Depth of the nearest triangle along a ray from the origin; 0: none. `margin`: how far from the triangle's outline, in
// barycentric coordinates, the hit must be; hits and misses nearer to it set `doubtful`.
double Cast(const ModelView& model, const Pose& T, const Vector3d& ray, bool& doubtful) {
  double nearest = 0;
  for (const ModelTriangle& t : model.triangles) {
    const Vector3d a = T * model.VertexPosition(t.vertex[0]).cast<double>();
    const Vector3d b = T * model.VertexPosition(t.vertex[1]).cast<double>();
    const Vector3d c = T * model.VertexPosition(t.vertex[2]).cast<double>();
    Matrix3d M;
    M << b - a, c - a, -ray;
    if (std::abs(M.determinant()) < 1e-12) continue;
    const Vector3d s = M.inverse() * -a;  // a + s0 (b - a) + s1 (c - a) = s2 ray
    const double inside = std::min({s.x(), s.y(), 1 - s.x() - s.y()});
    if (std::abs(inside) < 0.03 && s.z() > 0) doubtful = true;
    if (inside < 0 || s.z() <= 0) continue;
    if (nearest == 0 || s.z() < nearest) nearest = s.z();
  }
  return nearest;
}

TEST(SurfaceMap, AgreesWithRayCasting) {
  const RectifiedCamera camera = testing::TestCamera();
  Random random(1);
  const auto surface = std::make_unique<SurfaceMap>();
  for (const char* name : {"parcel_box", "juice_dispenser"}) {
    const TestModel model = testing::Load(name);
    for (int k = 0; k < testing::Cases(20); ++k) {
      const Pose T = testing::AnyView(random, *model, camera, random.Uniform(60, 500));
      RenderSurface(camera, *model, T, *surface);
      int compared = 0;
      for (int j = surface->y0; j < surface->y1; ++j) {
        for (int i = surface->x0; i < surface->x1; ++i) {
          const Vector3d ray((4 * i - camera.cx) / camera.f, (4 * j - camera.cy) / camera.f, 1);
          bool doubtful = false;
          const double z = Cast(model->view, T, ray, doubtful);
          if (doubtful) continue;
          ++compared;
          const double expected = z > 0 ? camera.DisparityOfDepth(z) : 0;
          ASSERT_NEAR(static_cast<double>(surface->At(i, j)), expected, 0.01 + 1e-4 * expected)
              << name << " " << i << " " << j;
        }
      }
      EXPECT_GT(compared, 20);
    }
  }
}

TEST(SurfaceMap, OutsideOfTheImageIsEmpty) {
  const RectifiedCamera camera = testing::TestCamera();
  const TestModel model = testing::Load("parcel_box");
  const auto surface = std::make_unique<SurfaceMap>();
  Random random(2);
  for (const Vector3d& t :
       {Vector3d(5, 0, 1), Vector3d(-5, 0, 1), Vector3d(0, 5, 1), Vector3d(0, 0, -2), Vector3d(0, 0, 0)}) {
    RenderSurface(camera, *model, {testing::AnyRotation(random), t}, *surface);
    for (int j = surface->y0; j < surface->y1; ++j) {
      for (int i = surface->x0; i < surface->x1; ++i) EXPECT_EQ(surface->At(i, j), 0) << t.x() << " " << t.z();
    }
  }
}

class SurfaceEvidenceTest : public ::testing::Test {
 protected:
  SurfaceEvidenceTest() {
    Random random(3);
    T_ = testing::AnyView(random, *model_, camera_, 200);
    RenderSurface(camera_, *model_, T_, *surface_);
    z_ = T_.t.z();
  }
  // A scene whose disparity at the pixel is what `at` says.
  SurfaceEvidence Gather(const std::function<double(float surface)>& at) {
    scene_->width = camera_.width / 2;
    scene_->height = camera_.height / 2;
    for (int y = 0; y < scene_->height; ++y) {
      for (int x = 0; x < scene_->width; ++x) {
        const int i = x / 2, j = y / 2;
        const bool in = i >= surface_->x0 && i < surface_->x1 && j >= surface_->y0 && j < surface_->y1;
        const double d = at(in ? surface_->At(i, j) : 0.0F);
        scene_->disparity[static_cast<std::size_t>(y * DisparityMap::kMaxWidth + x)] =
            static_cast<std::uint16_t>(d * static_cast<double>(DisparityMap::kOne) + 0.5);
      }
    }
    SurfaceEvidence out;
    GatherSurfaceEvidence({}, *scene_, *surface_, out);
    return out;
  }

  RectifiedCamera camera_ = testing::TestCamera();
  TestModel model_ = testing::Load("parcel_box");
  Pose T_;
  double z_ = 1;
  std::unique_ptr<SurfaceMap> surface_ = std::make_unique<SurfaceMap>();
  std::unique_ptr<DisparityMap> scene_ = std::make_unique<DisparityMap>();
};

TEST_F(SurfaceEvidenceTest, TheObjectBeforeAWall) {
  const SurfaceEvidence e = Gather([](float surface) { return surface > 0 ? static_cast<double>(surface) : 10.0; });
  EXPECT_GT(e.on, 0.95F);
  EXPECT_GT(e.drop, 0.9F);
  EXPECT_EQ(e.through, 0);
}

TEST_F(SurfaceEvidenceTest, OnlyTheWall) {
  const SurfaceEvidence e = Gather([](float) { return 10.0; });
  EXPECT_GT(e.through, 0.95F);
  EXPECT_EQ(e.on, 0);
}

TEST_F(SurfaceEvidenceTest, AnOccluderIsNotHeldAgainstIt) {
  const SurfaceEvidence e = Gather([](float) { return 150.0; });
  EXPECT_EQ(e.on, 0);
  EXPECT_EQ(e.through, 0);
  EXPECT_EQ(e.drop, 0);
}

TEST_F(SurfaceEvidenceTest, NothingKnownSaysNothing) {
  const SurfaceEvidence e = Gather([](float) { return 0.0; });
  EXPECT_EQ(e.on, 0);
  EXPECT_EQ(e.through, 0);
  EXPECT_EQ(e.drop, 0);
  EXPECT_EQ(e.level, 0);
}

}  // namespace
}  // namespace wirepose
