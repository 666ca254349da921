#include "sim/truth.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "sim/lens.h"
#include "test_scenes.h"

namespace wirepose::sim {
namespace {

// The honest oracle: every triangle in double precision (Moeller and Trumbore 1997). Returns the
// ray parameter or infinity.
double Cast(const Scene& scene, std::size_t instance, const Vector3d& origin, const Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  const Instance& object = scene.instances[instance];
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(object.mesh)];
  for (const auto& triangle : mesh.triangles) {
    const Vector3d a = object.T_world_object * mesh.vertices[triangle[0]].cast<double>();
    const Vector3d b = object.T_world_object * mesh.vertices[triangle[1]].cast<double>();
    const Vector3d c = object.T_world_object * mesh.vertices[triangle[2]].cast<double>();
    Matrix3d M;
    M << direction, a - b, a - c;
    const Vector3d solution = M.fullPivLu().solve(a - origin);  // t, beta, gamma
    const bool is_inside = solution[1] >= 0 && solution[2] >= 0 && solution[1] + solution[2] <= 1 && solution[0] > 0;
    if (is_inside) nearest = std::min(nearest, solution[0]);
  }
  return nearest;
}

// Two boxes, one partly before the other, in a tiny camera; poses differ from case to case.
Scene TwoBoxes(Random& random) {
  Scene scene;
  scene.meshes = {MakeBox({0.3F, 0.2F, 0.15F}), MakeBox({0.15F, 0.25F, 0.1F})};
  Pose back{test::AnyRotation(random), Vector3d(random.Uniform(-0.1, 0.1), 0.02, 1.2)};
  Pose front{test::AnyRotation(random), Vector3d(random.Uniform(-0.1, 0.1), -0.03, 0.7)};
  scene.instances = {test::Glowing(0, back), test::Glowing(1, front)};
  scene.instances[1].obj_id = 2;
  return scene;
}

TEST(Truth, AgreesWithBruteForce) {
  Random random(21);
  const Camera camera = test::LeftOf(test::SmallCalibration(0.125));
  const Lens lens(camera.intrinsics);
  for (int n = 0; n < 5; ++n) {
    const Scene scene = TwoBoxes(random);
    const Truth truth = FindTruth(Renderer(scene), camera, 2);
    int visible[2] = {}, all[2] = {}, depth_errors = 0;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Vector2d xy = lens.RayOf(Vector2d(x, y))->xy;
        const Vector3d direction(xy.x(), xy.y(), 1);
        const double t0 = Cast(scene, 0, Vector3d::Zero(), direction);
        const double t1 = Cast(scene, 1, Vector3d::Zero(), direction);
        all[0] += std::isfinite(t0) ? 1 : 0;
        all[1] += std::isfinite(t1) ? 1 : 0;
        const double t = std::min(t0, t1);
        if (std::isfinite(t)) ++visible[t0 < t1 ? 0 : 1];
        const double seen = double{truth.depth_m[static_cast<std::size_t>(y * camera.width + x)]};
        depth_errors += std::abs(seen - (std::isfinite(t) ? t : 0)) > 1e-5 ? 1 : 0;
      }
    }
    ASSERT_EQ(truth.objects.size(), 2U);
    for (std::size_t k = 0; k < 2; ++k) {
      // A ray that grazes an edge may fall to either side in single precision.
      EXPECT_NEAR(truth.objects[k].px_count_in_image, all[k], 1);
      EXPECT_NEAR(truth.objects[k].px_count_visib, visible[k], 2);
      EXPECT_DOUBLE_EQ(truth.objects[k].visib_fract,
                       double(truth.objects[k].px_count_visib) / truth.objects[k].px_count_all);
    }
    EXPECT_LE(depth_errors, 2);
  }
}

// Moving the principal point moves the image window only: the silhouette does not change.
TEST(Truth, CountsTheSilhouetteOutsideOfTheImage) {
  Pose T;
  T.R = Eigen::AngleAxisd(0.5, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  T.t = Vector3d(0, 0, 1);
  const Renderer renderer(test::GlowingBox({0.3F, 0.2F, 0.15F}, T));
  const Camera whole{{300, 300, 160, 120}, 320, 240, Pose{}, 0.5};
  Camera cut = whole;
  cut.intrinsics.cx = -10;  // the object's middle lies left of the image
  const ObjectTruth in_whole = FindTruth(renderer, whole, 2).objects[0];
  const ObjectTruth in_cut = FindTruth(renderer, cut, 2).objects[0];
  EXPECT_EQ(in_whole.px_count_all, in_whole.px_count_in_image);
  EXPECT_EQ(in_whole.visib_fract, 1);
  EXPECT_EQ(in_cut.px_count_all, in_whole.px_count_all);
  EXPECT_GT(in_cut.px_count_in_image, 0);
  EXPECT_LT(in_cut.visib_fract, 0.5);
  EXPECT_EQ(in_cut.bbox_visib[0], 0);
}

TEST(Truth, ObjectBehindTheCameraIsNotVisible) {
  Pose T;
  T.t = Vector3d(0, 0, -1);
  const Renderer renderer(test::GlowingBox({0.3F, 0.2F, 0.15F}, T));
  const Truth truth = FindTruth(renderer, {{300, 300, 160, 120}, 320, 240, Pose{}, 0.5}, 1);
  EXPECT_EQ(truth.objects[0].px_count_all, 0);
  EXPECT_EQ(truth.objects[0].visib_fract, 0);
}

// n . p = d seen along (x, y, 1) lies at depth d / (n . (x, y, 1)).
TEST(Truth, DepthOfAPlane) {
  Pose T;
  T.R = Eigen::AngleAxisd(0.4, Vector3d::UnitX()).toRotationMatrix();
  T.t = Vector3d(0, 0, 1);
  const Renderer renderer(test::GlowingBox({4.0F, 4.0F, 0.01F}, T));
  const Camera camera = test::LeftOf(test::SmallCalibration());
  const Truth truth = FindTruth(renderer, camera, 2);
  const Lens lens(camera.intrinsics);
  const Vector3d normal = T.R.col(2);
  const double d = normal.dot(T.t) - 0.005;  // of the side that faces the camera
  for (int y = 0; y < camera.height; y += 7) {
    for (int x = 0; x < camera.width; x += 7) {
      const Vector2d xy = lens.RayOf(Vector2d(x, y))->xy;
      const double expected = d / normal.dot(Vector3d(xy.x(), xy.y(), 1));
      const double seen = double{truth.depth_m[static_cast<std::size_t>(y * camera.width + x)]};
      EXPECT_NEAR(seen, expected, 2e-6);
    }
  }
}

TEST(Truth, PoseIsThatOfTheCamera) {
  Random random(22);
  const Pose T_world_object{test::AnyRotation(random), Vector3d(0.3, 0.1, 0.4)};
  const Pose T_camera_object{test::AnyRotation(random), Vector3d(0.02, -0.01, 0.9)};
  const Renderer renderer(test::GlowingBox({0.3F, 0.2F, 0.15F}, T_world_object));
  Camera camera = test::LeftOf(test::SmallCalibration());
  camera.T_world_camera = T_world_object * T_camera_object.Inverse();
  const Truth truth = FindTruth(renderer, camera, 2);
  EXPECT_TRUE(truth.objects[0].T_camera_object.R.isApprox(T_camera_object.R, 1e-12));
  EXPECT_TRUE(truth.objects[0].T_camera_object.t.isApprox(T_camera_object.t, 1e-12));
  EXPECT_GT(truth.objects[0].px_count_visib, 100);
}

}  // namespace
}  // namespace wirepose::sim
