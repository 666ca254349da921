#include "stages/sample_edges.h"

#include <algorithm>
#include <cmath>

namespace wirepose {
namespace {

// Where the segment eye -> point meets a triangle, as a share of its length; outside [0, 1] or NaN: nowhere that hides.
// (Moeller & Trumbore 1997.)
bool Blocks(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& eye, const Vector3& ray) {
  const Vector3 ab = b - a, ac = c - a;
  const Vector3 p = ray.cross(ac);
  const float det = ab.dot(p);
  if (std::abs(det) < 1e-12F) return false;
  const Vector3 s = eye - a;
  const float u = s.dot(p) / det;
  if (u < 0 || u > 1) return false;
  const Vector3 q = s.cross(ab);
  const float v = ray.dot(q) / det;
  if (v < 0 || u + v > 1) return false;
  const float t = ac.dot(q) / det;
  return t > 0 && t < 0.997F;  // what is nearer than 3 per mille of the distance belongs to the edge itself
}

// Image of a point in the rectified pair.
struct Seen {
  Vector2 left;
  float disparity;
};

Seen ProjectPoint(const RectifiedCamera& camera, const Vector3& p) {
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
    FrontTriangle front{static_cast<std::uint16_t>(i), Vector2(1e9F, 1e9F), Vector2(-1e9F, -1e9F)};
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
    out.push_back(front);
  }
}

bool IsHidden(const ModelView& model, const FrontTriangles& front, const Vector3& eye, const Vector3& point,
              const Vector2& image, std::uint16_t a, std::uint16_t b) {
  const Vector3 ray = point - eye;
  for (const FrontTriangle& f : front) {
    if (image.x() < f.low.x() || image.y() < f.low.y() || image.x() > f.high.x() || image.y() > f.high.y()) continue;
    const ModelTriangle& t = model.triangles[f.triangle];
    if (t.face == a || t.face == b) continue;
    if (Blocks(model.VertexPosition(t.vertex[0]), model.VertexPosition(t.vertex[1]), model.VertexPosition(t.vertex[2]),
               eye, ray)) {
      return true;
    }
  }
  return false;
}

namespace {

// Front triangles other than those of faces `f` and `g` whose bounding box meets that of the image edge a-b.
void FindNear(const ModelView& model, const FrontTriangles& front, const Vector2& a, const Vector2& b, std::uint16_t f,
              std::uint16_t g, FrontTriangles& out) {
  const Vector2 low = a.cwiseMin(b), high = a.cwiseMax(b);
  out.clear();
  for (const FrontTriangle& t : front) {
    if (t.low.x() > high.x() || t.low.y() > high.y() || t.high.x() < low.x() || t.high.y() < low.y()) continue;
    const std::uint16_t face = model.triangles[t.triangle].face;
    if (face != f && face != g) out.push_back(t);
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
      const Seen pa = ProjectPoint(camera, a), pb = ProjectPoint(camera, b);
      const float length = (pb.left - pa.left).norm();
      if (length >= params.min_edge_px) use(e, a, b, pa, pb, length);
    }
  };
  float total = 0;
  for_each_edge([&](std::size_t, const Vector3&, const Vector3&, const Seen&, const Seen&, float length) {
    total += length + params.step_px;
  });
  const float step = std::max(params.step_px, total / static_cast<float>(kMaxEdgeSamples));

  FrontTriangles near_edge;  // that may hide a part of the edge at hand
  for_each_edge([&](std::size_t e, const Vector3& a, const Vector3& b, const Seen& pa, const Seen& pb, float length) {
    const int n = std::max(1, static_cast<int>(length / step));
    EdgeSample sample;
    sample.edge = static_cast<std::uint16_t>(e);
    sample.tangent = Unit(pb.left - pa.left);
    sample.tangent_right = Unit(pb.left - pa.left - Vector2(pb.disparity - pa.disparity, 0));
    sample.weight_px = length / static_cast<float>(n);
    const ModelEdge& edge = model.view.edges[e];
    if (!model.convex) FindNear(model.view, scratch, pa.left, pb.left, edge.face[0], edge.face[1], near_edge);
    for (int k = 0; k < n && !out.full(); ++k) {
      // Even steps in the image are uneven steps in space: interpolate with the depths.
      const float s = (static_cast<float>(k) + 0.5F) / static_cast<float>(n);
      const float w = s * a.z() / (s * a.z() + (1 - s) * b.z());
      sample.point = model.edges[e].a + w * (model.edges[e].b - model.edges[e].a);
      sample.left = pa.left + s * (pb.left - pa.left);
      sample.disparity = pa.disparity + s * (pb.disparity - pa.disparity);
      if (!near_edge.empty() &&
          IsHidden(model.view, near_edge, eye, sample.point, sample.left, edge.face[0], edge.face[1]))
        continue;
      out.push_back(sample);
    }
  });
}

}  // namespace wirepose
