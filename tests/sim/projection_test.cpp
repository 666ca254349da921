// The rendered silhouette of a box against its corners and edges as OpenCV projects them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "opencv_projection.h"
#include "sim/renderer.h"
#include "test_scenes.h"

namespace wirepose::sim {
namespace {

using Eigen::Vector2d;

constexpr int kPointsPerEdge = 64;

// One edge of the outline, in pixels, with the object to the right when walking from first to last
// (y down).
using OutlineEdge = std::vector<Vector2d>;

// The box's edges between a face that the camera sees and one that it does not, in the order of the
// outline.
std::vector<OutlineEdge> Outline(const Vector3d& size, const Pose& T_camera_object,
                                 const CameraIntrinsics& intrinsics) {
  std::vector<std::pair<Vector3d, Vector3d>> edges;
  const Vector3d camera = T_camera_object.Inverse() * Vector3d::Zero();
  const auto sees = [&](int axis, int sign) { return sign * camera[axis] > size[axis] / 2; };
  for (int axis = 0; axis < 3; ++axis) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (const int sb : {-1, 1}) {
      for (const int sc : {-1, 1}) {
        if (sees(b, sb) == sees(c, sc)) continue;
        Vector3d low, high;
        low[axis] = -size[axis] / 2;
        high[axis] = size[axis] / 2;
        low[b] = high[b] = sb * size[b] / 2;
        low[c] = high[c] = sc * size[c] / 2;
        edges.emplace_back(low, high);
      }
    }
  }
  std::vector<OutlineEdge> outline;
  Vector3d at = edges.front().first;
  for (std::size_t n = edges.size(); n > 0; --n) {
    for (auto& [from, to] : edges) {
      if ((to - at).norm() < 1e-9) std::swap(from, to);
      if ((from - at).norm() > 1e-9) continue;
      std::vector<Vector3d> points;
      for (int i = 0; i <= kPointsPerEdge; ++i) {
        points.push_back(T_camera_object * (from + (to - from) * i / kPointsPerEdge));
      }
      outline.push_back(test::ProjectWithOpenCv(intrinsics, points));
      at = to;
      from = to = Vector3d::Constant(1e9);  // used
      break;
    }
  }
  return outline;
}

struct Region {
  double area = 0;
  Vector2d centroid = Vector2d::Zero();
};

// Area (positive when the object is to the right) and centroid of a polygon: Green's theorem.
Region RegionOf(const std::vector<OutlineEdge>& outline) {
  Region region;
  for (const OutlineEdge& edge : outline) {
    for (std::size_t i = 1; i < edge.size(); ++i) {
      const Vector2d &a = edge[i - 1], &b = edge[i];
      const double cross = a.x() * b.y() - b.x() * a.y();
      region.area += cross / 2;
      region.centroid += (a + b) * cross / 6;
    }
  }
  region.centroid /= region.area;
  return region;
}

Region RegionOf(const RadianceImage& image) {
  Region region;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      region.area += double{image(x, y)};
      region.centroid += double{image(x, y)} * Vector2d(x, y);
    }
  }
  region.centroid /= region.area;
  return region;
}

double Bilinear(const RadianceImage& image, const Vector2d& p) {
  const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
  const double u = p.x() - x, v = p.y() - y;
  return (1 - v) * ((1 - u) * double{image(x, y)} + u * double{image(x + 1, y)}) +
         v * ((1 - u) * double{image(x, y + 1)} + u * double{image(x + 1, y + 1)});
}

// How far the rendered edge lies outside of the expected one at its i-th point, px.
double EdgeOffset(const RadianceImage& image, const OutlineEdge& edge, std::size_t i, double sign) {
  const Vector2d along = (edge[i + 1] - edge[i - 1]).normalized();
  const Vector2d inwards = sign * Vector2d(-along.y(), along.x());
  constexpr double kReach = 4, kStep = 0.05;
  double covered = 0;
  for (double d = -kReach + kStep / 2; d < kReach; d += kStep) {
    covered += kStep * Bilinear(image, edge[i] + d * inwards);
  }
  return covered - kReach;
}

struct Case {
  StereoCalibration calibration = test::SmallCalibration(0.5);
  Vector3d size{0.3, 0.2, 0.15};
  Pose T_camera_object;
};

Case AnyCase(Random& random) {
  Case c;
  c.T_camera_object.R = test::AnyRotation(random);
  c.T_camera_object.t = Vector3d(random.Uniform(-0.15, 0.15), random.Uniform(-0.08, 0.08), random.Uniform(0.9, 1.3));
  return c;
}

TEST(Projection, SilhouetteAgreesWithOpenCv) {
  Random random(11);
  for (int i = 0; i < 8; ++i) {
    const Case c = AnyCase(random);
    const Camera camera = test::LeftOf(c.calibration);
    const Renderer renderer(test::GlowingBox(c.size.cast<float>(), c.T_camera_object));
    const Region seen = RegionOf(renderer.Render(camera, {.samples_per_side = 6}));
    const Region expected = RegionOf(Outline(c.size, c.T_camera_object, c.calibration.left));
    EXPECT_LT((seen.centroid - expected.centroid).norm(), 0.01) << "case " << i;
    EXPECT_NEAR(seen.area / std::abs(expected.area), 1, 1e-3) << "case " << i;
  }
}

TEST(Projection, EveryEdgeAgreesWithOpenCv) {
  Random random(12);
  for (int i = 0; i < 8; ++i) {
    const Case c = AnyCase(random);
    const Renderer renderer(test::GlowingBox(c.size.cast<float>(), c.T_camera_object));
    const RadianceImage image = renderer.Render(test::LeftOf(c.calibration), {});
    const std::vector<OutlineEdge> outline = Outline(c.size, c.T_camera_object, c.calibration.left);
    const double sign = RegionOf(outline).area > 0 ? 1 : -1;
    for (const OutlineEdge& edge : outline) {
      if ((edge.back() - edge.front()).norm() < 40) continue;  // its ends blur into the middle
      double sum = 0;
      int count = 0;
      for (std::size_t k = kPointsPerEdge / 4; k <= kPointsPerEdge * 3 / 4; ++k, ++count) {
        sum += EdgeOffset(image, edge, k, sign);
      }
      EXPECT_NEAR(sum / count, 0, 0.03) << "case " << i;
    }
  }
}

// Edges along the pixel rows and columns are where sampling on a regular grid would go wrong.
TEST(Projection, AxisAlignedEdgesAreSubPixelExact) {
  CameraIntrinsics pinhole{400, 400, 160, 120};
  const Camera camera{pinhole, 320, 240, Pose{}, 0.5};
  for (int i = 0; i < 8; ++i) {
    Pose T;
    T.t = Vector3d(0.0003 * i, 0.00017 * i, 1 + 1e-3 / 2);  // front face at z = 1: 0.12 px a step
    const Renderer renderer(test::GlowingBox({0.4F, 0.3F, 1e-3F}, T));
    const Region seen = RegionOf(renderer.Render(camera, {}));
    EXPECT_NEAR(seen.centroid.x(), 160 + 400 * T.t.x(), 0.005);
    EXPECT_NEAR(seen.centroid.y(), 120 + 400 * T.t.y(), 0.005);
  }
}

TEST(Projection, PointSpreadKeepsLightAndWidensEdges) {
  CameraIntrinsics pinhole{400, 400, 160, 120};
  Pose T;
  T.t = Vector3d(0, 0, 1);
  const Renderer renderer(test::GlowingBox({0.2F, 0.2F, 1e-3F}, T));
  double areas[2] = {}, spreads[2] = {};
  for (int i = 0; i < 2; ++i) {
    const Camera camera{pinhole, 320, 240, Pose{}, i == 0 ? 0.0 : 1.0};
    const RadianceImage image = renderer.Render(camera, {.samples_per_side = 6});
    areas[i] = RegionOf(image).area;
    // Second moment of the edge's derivative along the middle row: variance of the point spread.
    double sum = 0, mean = 0, square = 0;
    for (int x = 100; x < 160; ++x) {
      const double slope = double{image(x + 1, 120)} - double{image(x, 120)};
      sum += slope;
      mean += slope * x;
      square += slope * x * x;
    }
    spreads[i] = square / sum - (mean / sum) * (mean / sum);
  }
  EXPECT_NEAR(areas[1] / areas[0], 1, 1e-3);
  EXPECT_NEAR(spreads[1] - spreads[0], 1.0, 0.1);
}

}  // namespace
}  // namespace wirepose::sim
