// Hidden lines against the geometry of a box; the picture against what must be in it.
#include "tools/overlay/overlay.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <random>
#include <vector>

#include "box_model.h"
#include "tools/overlay/visible_edges.h"

namespace wirepose::overlay {
namespace {

using wirepose::testing::BoxModel;

Pose BoxAhead(const Matrix3d& R) { return {R, Vector3d(0.05, -0.02, 1)}; }

// Visibility of a convex body's edge from its faces: an edge is seen when one of its two faces is
// turned to the camera.
bool SeesEdge(const BoxModel& box, const Pose& T, const ModelEdge& edge) {
  const Vector3d camera_in_model = T.Inverse().t;
  const Vector3d half = box.view().VertexPosition(7).cast<double>();
  const int a = edge.vertex[0], b = edge.vertex[1];
  for (int axis = 0; axis < 3; ++axis) {
    if (((a ^ b) >> axis & 1) != 0) continue;  // the edge runs along this axis
    const double side = (a >> axis & 1) != 0 ? 1 : -1;
    if (side * camera_in_model[axis] > half[axis]) return true;
  }
  return false;
}

TEST(VisibleEdges, OfABoxAreThoseOfTheFacesTurnedToTheCamera) {
  const BoxModel box(0.3F, 0.2F, 0.15F);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle(-3, 3);
  int seen = 0, hidden = 0;
  for (int n = 0; n < 300; ++n) {
    const Pose T = BoxAhead(ExpSo3({angle(random), angle(random), angle(random)}));
    for (const EdgePiece& piece : CutEdges(box.view(), T)) {
      const bool expected = SeesEdge(box, T, box.view().edges[piece.edge]);
      const double share = (piece.b - piece.a).norm() / static_cast<double>(box.view().diameter_m);
      // Next to a corner a ray of a hidden edge leaves through the tolerance: short pieces may be
      // called either way.
      if (share < 0.05) continue;
      EXPECT_EQ(piece.hidden, !expected) << "pose " << n << " edge " << piece.edge;
      ++(expected ? seen : hidden);
    }
  }
  EXPECT_GT(seen, 300 * 6);
  EXPECT_GT(hidden, 300 * 2);
}

TEST(VisibleEdges, PiecesOfAnEdgeCoverIt) {
  const BoxModel box(0.3F, 0.2F, 0.15F);
  const Pose T = BoxAhead(ExpSo3({0.4, 0.5, 0.1}));
  std::vector<double> covered(box.view().edges.size());
  for (const EdgePiece& p : CutEdges(box.view(), T)) covered[p.edge] += (p.b - p.a).norm();
  for (std::size_t e = 0; e < covered.size(); ++e) {
    const ModelEdge& edge = box.view().edges[e];
    const double length = static_cast<double>(
        (box.view().VertexPosition(edge.vertex[0]) - box.view().VertexPosition(edge.vertex[1])).norm());
    EXPECT_NEAR(covered[e], length, 1e-6);
  }
}

TEST(VisibleEdges, NothingBehindTheCameraIsReturned) {
  const BoxModel box(0.3F, 0.2F, 0.15F);
  EXPECT_TRUE(CutEdges(box.view(), {Matrix3d::Identity(), Vector3d(0, 0, -1)}).empty());
  for (const EdgePiece& p : CutEdges(box.view(), {Matrix3d::Identity(), Vector3d(0, 0, 0)})) {
    EXPECT_GE(std::min(p.a.z(), p.b.z()), 0.01);
  }
}

class OverlayTest : public ::testing::Test {
 protected:
  OverlayTest() : pixels_(640 * 480, 100) {
    input_.left_rectified = {pixels_.data(), 640, 480, 640};
    input_.camera = {500, 320, 240, 0.1, 640, 480};
    Segment2 segment;
    segment.a = {100, 100};
    segment.b = {200, 100};
    segments_.push_back(segment);
    Line3& line = lines_.emplace_back();
    line.segment = segment;
    line.segment.a.y() = line.segment.b.y() = 300;
    line.has_depth = true;
    line.a = line.b = {0, 0, 1};
  }

  std::vector<std::uint8_t> pixels_;
  std::vector<Segment2> segments_;
  std::vector<Line3> lines_;
  OverlayInput input_;
};

bool IsColoured(const cv::Mat& image, int x, int y) {
  const cv::Vec3b p = image.at<cv::Vec3b>(y, x);
  return std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 60;
}

TEST_F(OverlayTest, OfNothingIsTheImageTwice) {
  const cv::Mat image = DrawOverlay(input_);
  EXPECT_EQ(image.size(), cv::Size(2 * 2 * 640, 2 * 480));
  EXPECT_EQ(image.at<cv::Vec3b>(500, 700), cv::Vec3b(90, 90, 90));
}

TEST_F(OverlayTest, ShowsLinesBySideAndDepth) {
  input_.segments = segments_;
  input_.lines = lines_;
  input_.line_sets = {{3, 0}};
  const cv::Mat image = DrawOverlay(input_);
  // The line's centre falls between two rows of the enlarged picture: both are half grey.
  EXPECT_GT(image.at<cv::Vec3b>(201, 300)[0], 110) << "a segment without depth is grey";
  EXPECT_FALSE(IsColoured(image, 300, 201));
  EXPECT_TRUE(IsColoured(image, 300, 601)) << "a 3D line is coloured by depth on the left";
  EXPECT_TRUE(IsColoured(image, 1280 + 300, 601)) << "and by its set on the right";
}

TEST_F(OverlayTest, DrawsTheModelWhereItProjects) {
  const BoxModel box(0.2F, 0.2F, 0.2F);
  input_.objects.push_back({box.view(), {Matrix3d::Identity(), Vector3d(0, 0, 1.1)}, PoseKind::kFound, "box 0.97"});
  const cv::Mat image = DrawOverlay(input_);
  // The front face is at 1 m: its right edge at u = 320 + 50, from v = 190 to 290.
  EXPECT_TRUE(IsColoured(image, 1280 + 2 * 370, 2 * 240));
  EXPECT_FALSE(IsColoured(image, 1280 + 2 * 385, 2 * 240));
}

TEST_F(OverlayTest, SurvivesPosesThatCannotBeDrawn) {
  const BoxModel box(0.2F, 0.2F, 0.2F);
  input_.objects.push_back({box.view(), {Matrix3d::Identity(), Vector3d(0, 0, -1)}, PoseKind::kTruth, "behind"});
  input_.objects.push_back({box.view(), {Matrix3d::Identity(), Vector3d(500, 0, 0.2)}, PoseKind::kFound, "beside"});
  EXPECT_FALSE(DrawOverlay(input_).empty());
}

}  // namespace
}  // namespace wirepose::overlay
