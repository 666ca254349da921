#include "stages/sample_edges.h"

#include <algorithm>
#include <cmath>

namespace wirepose {
namespace {

// What rays from `eye` need to know of a triangle.
void PrepareRays(const ModelView& model, const Vector3& eye, FrontTriangle& out) {
  const auto& vertex = model.triangles[out.triangle].vertex;
  const Vector3 a = model.VertexPosition(vertex[0]);
  const Vector3 p = model.VertexPosition(vertex[1]) - a, q = model.VertexPosition(vertex[2]) - a, s = eye - a;
  const Vector3 normal = p.cross(q);
  const float side = s.dot(normal) < 0 ? -1 : 1;  // whichever way the corners turn
  out.d = -side * normal;
  out.u = side * q.cross(s);
  out.v = side * s.cross(p);
  out.h = side * s.dot(normal);
}

// Image of a point in the rectified pair.
struct StereoPoint {
  Vector2 left;
  float disparity;
};

StereoPoint ProjectPoint(const RectifiedCamera& camera, const Vector3& p) {
  const auto f = static_cast<float>(camera.f);
  const float z = f / p.z();
  return {{p.x() * z + static_cast<float>(camera.cx), p.y() * z + static_cast<float>(camera.cy)},
          static_cast<float>(camera.baseline) * z};
}

Vector2 Unit(const Vector2& v) {
  const float n = v.norm();
  return n > 1e-6F ? Vector2(v / n) : Vector2(1, 0);
}

}  // namespace

void FindFrontTriangles(const RectifiedCamera& camera, const ModelView& model, const Pose& T_camera_model,
                        FrontTriangles& out) {
  out.clear();
  const Matrix3 R = T_camera_model.R.cast<float>();
  const Vector3 t = T_camera_model.t.cast<float>();
  const Vector3 eye = -(R.transpose() * t);
  for (std::size_t i = 0; i < model.triangles.size(); ++i) {
    const ModelTriangle& triangle = model.triangles[i];
    if (!IsTowards(model.faces[triangle.face], eye)) continue;
    FrontTriangle front;
    front.triangle = static_cast<std::uint16_t>(i);
    front.face = triangle.face;
    front.low.setConstant(1e9F);
    front.high.setConstant(-1e9F);
    for (const std::uint16_t v : triangle.vertex) {
      const Vector3 p = R * model.VertexPosition(v) + t;
      if (p.z() < 0.02F) {  // reaches behind the camera: may hide anything
        front.low.setConstant(-1e9F);
        front.high.setConstant(1e9F);
        break;
      }
      const Vector2 u = ProjectPoint(camera, p).left;
      front.low = front.low.cwiseMin(u);
      front.high = front.high.cwiseMax(u);
    }
    PrepareRays(model, eye, front);
    out.push_back(front);
  }
}

bool IsHidden(const FrontTriangles& front, const Vector3& ray, const Vector2& image, std::uint16_t face) {
  return std::any_of(front.begin(), front.end(),
                     [&](const FrontTriangle& f) { return f.face != face && f.Hides(ray, image); });
}

namespace {

using NearTriangles = FixedVector<std::uint16_t, kMaxModelTriangles>;  // indices of front triangles

// Front triangles other than those of the edge's own faces whose bounding box meets that of the image edge a-b.
void FindNear(const FrontTriangles& front, const Vector2& a, const Vector2& b, const ModelEdge& edge,
              NearTriangles& out) {
  const Vector2 low = a.cwiseMin(b), high = a.cwiseMax(b);
  out.clear();
  for (std::size_t i = 0; i < front.size(); ++i) {
    const FrontTriangle& t = front[i];
    if (t.low.x() > high.x() || t.low.y() > high.y() || t.high.x() < low.x() || t.high.y() < low.y()) continue;
    if (t.face != edge.face[0] && t.face != edge.face[1]) out.push_back(static_cast<std::uint16_t>(i));
  }
}

}  // namespace

void SampleVisibleEdges(const SampleParams& params, const RectifiedCamera& camera, const PreparedModel& model,
                        const Pose& T_camera_model, FrontTriangles& scratch, EdgeSamples& out) {
  out.clear();
  const Matrix3 R = T_camera_model.R.cast<float>();
  const Vector3 t = T_camera_model.t.cast<float>();
  const Vector3 eye = -(R.transpose() * t);
  if (!model.convex) FindFrontTriangles(camera, model.view, T_camera_model, scratch);
  const float near = (R * model.centre + t).z() / params.max_depth_ratio;

  const auto for_each_edge = [&](const auto& use) {
    for (std::size_t e = 0; e < model.edges.size(); ++e) {
      if (!model.FacesEye(e, eye)) continue;
      const Vector3 a = R * model.edges[e].a + t, b = R * model.edges[e].b + t;
      if (a.z() < near || b.z() < near) continue;
      const StereoPoint pa = ProjectPoint(camera, a), pb = ProjectPoint(camera, b);
      const float length = (pb.left - pa.left).norm();
      if (length >= params.min_edge_px) use(e, a, b, pa, pb, length);
    }
  };
  float total = 0;
  for_each_edge([&](std::size_t, const Vector3&, const Vector3&, const StereoPoint&, const StereoPoint&, float length) {
    total += length + params.step_px;
  });
  const float step = std::max(params.step_px, total / static_cast<float>(kMaxEdgeSamples));

  NearTriangles near_edge;  // that may hide a part of the edge at hand
  for_each_edge([&](std::size_t e, const Vector3& a, const Vector3& b, const StereoPoint& pa, const StereoPoint& pb,
                    float length) {
    const int n = std::max(1, static_cast<int>(length / step));
    EdgeSample sample;
    sample.edge = static_cast<std::uint16_t>(e);
    sample.tangent = Unit(pb.left - pa.left);
    sample.tangent_right = Unit(pb.left - pa.left - Vector2(pb.disparity - pa.disparity, 0));
    sample.weight_px = length / static_cast<float>(n);
    if (!model.convex) FindNear(scratch, pa.left, pb.left, model.view.edges[e], near_edge);
    for (int k = 0; k < n && !out.full(); ++k) {
      // Even steps in the image are uneven steps in space: interpolate with the depths.
      const float s = (static_cast<float>(k) + 0.5F) / static_cast<float>(n);
      const float w = s * a.z() / (s * a.z() + (1 - s) * b.z());
      sample.point = model.edges[e].a + w * (model.edges[e].b - model.edges[e].a);
      sample.left = pa.left + s * (pb.left - pa.left);
      sample.disparity = pa.disparity + s * (pb.disparity - pa.disparity);
      const auto hides = [&](std::uint16_t i) { return scratch[i].Hides(sample.point - eye, sample.left); };
      if (std::none_of(near_edge.begin(), near_edge.end(), hides)) out.push_back(sample);
    }
  });
}

}  // namespace wirepose
