#include "sim/edge_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "opencv_projection.h"
#include "test_scenes.h"

namespace wirepose::sim {
namespace {

TEST(SharpEdges, OfABoxAreTwelve) {
  const auto edges = SharpEdges(MakeBox({0.3F, 0.2F, 0.15F}));
  ASSERT_EQ(edges.size(), 12U);
  double length = 0;
  for (const auto& [a, b] : edges) length += (a - b).norm();
  EXPECT_NEAR(length, 4 * (0.3 + 0.2 + 0.15), 1e-6);
}

// The rounding of a cylinder with 64 sides is no edge, its two rims are.
TEST(SharpEdges, OfACylinderAreItsRims) { EXPECT_EQ(SharpEdges(MakeCylinder(0.05F, 0.1F, 64)).size(), 128U); }

TEST(SharpEdges, VerticesAtOnePlaceAreOne) {
  Mesh box = MakeBox({0.3F, 0.2F, 0.15F}), apart;
  for (const auto& t : box.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t i : t) apart.vertices.push_back(box.vertices[i]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(SharpEdges(apart).size(), 12U);
}

// Seen from a corner, nine of a box's twelve edges are in view, whole, and where OpenCV puts them.
TEST(VisibleEdgeParts, OfALonelyBox) {
  Random random(81);
  const Camera camera = test::LeftOf(test::SmallCalibration(0.5));
  for (int n = 0; n < 10; ++n) {
    const Pose T{test::AnyRotation(random), Vector3d(0, 0, 1.2)};
    const Renderer renderer(test::GlowingBox({0.3F, 0.2F, 0.15F}, T));
    const auto edges = SharpEdges(renderer.scene().meshes[0]);
    const Vector3d eye = T.Inverse() * Vector3d::Zero();
    const Vector3d half(0.15, 0.1, 0.075);
    std::set<int> expected;  // an edge is in view when one of its two faces is
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Vector3d middle = 0.5 * (edges[i][0] + edges[i][1]);
      for (int axis = 0; axis < 3; ++axis) {
        const double side = middle[axis] / half[axis];
        if (std::abs(side) > 0.5 && eye[axis] * side > half[axis]) expected.insert(static_cast<int>(i));
      }
    }
    std::set<int> seen;
    for (const dataset::EdgePart& part : VisibleEdgeParts(renderer, camera, 0)) {
      seen.insert(part.edge);
      EXPECT_LT(part.from, 0.02);
      EXPECT_GT(part.to, 0.98);
      const auto& edge = edges[static_cast<std::size_t>(part.edge)];
      const Vector3d start = T * (edge[0] + part.from * (edge[1] - edge[0]));
      const Vector2 pixel(static_cast<float>(part.pixels[0]), static_cast<float>(part.pixels[1]));
      EXPECT_LT((test::ProjectWithOpenCv(camera.intrinsics, {start})[0].cast<float>() - pixel).norm(), 1e-3F);
    }
    EXPECT_EQ(seen, expected) << "case " << n;
  }
}

// A post before the middle of an edge cuts it in two where its outline is.
TEST(VisibleEdgeParts, EndAtWhatIsInFront) {
  const Camera camera{{400, 400, 159.5, 119.5}, 320, 240, Pose{}, 0.5};
  Pose T;
  T.t = Vector3d(0, 0, 1.05);
  Scene scene = test::GlowingBox({0.4F, 0.2F, 0.1F}, T);
  scene.meshes.push_back(MakeBox({0.05F, 0.6F, 0.001F}));
  Instance post = test::Glowing(1, {});
  post.obj_id = 0;
  post.T_world_object.t = Vector3d(0, 0, 0.5);
  scene.instances.push_back(post);
  int halves = 0;
  for (const dataset::EdgePart& part : VisibleEdgeParts(Renderer(scene), camera, 0)) {
    const bool is_flat = std::abs(part.pixels[1] - part.pixels[3]) < 1;
    if (!is_flat) continue;
    ++halves;
    // The post covers 159.5 +- 20.02 px.
    const double inner = std::min(std::abs(part.pixels[0] - 159.5), std::abs(part.pixels[2] - 159.5));
    EXPECT_NEAR(inner, 20.02, 0.5);
  }
  EXPECT_EQ(halves, 4) << "upper and lower edge of the front, each in two parts";
}

TEST(VisibleEdgeParts, EndAtTheImagesBorder) {
  const Camera camera{{400, 400, 159.5, 119.5}, 320, 240, Pose{}, 0.5};
  Pose T;
  T.t = Vector3d(0.4, 0, 1.05);  // its middle at the right border
  for (const dataset::EdgePart& part : VisibleEdgeParts(Renderer(test::GlowingBox({0.4F, 0.2F, 0.1F}, T)), camera, 0)) {
    EXPECT_LE(std::max(part.pixels[0], part.pixels[2]), 319.5);
    const bool is_flat = std::abs(part.pixels[1] - part.pixels[3]) < 1;
    EXPECT_TRUE(!is_flat || std::max(part.pixels[0], part.pixels[2]) > 319);
  }
}

}  // namespace
}  // namespace wirepose::sim
