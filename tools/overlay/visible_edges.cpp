#include "tools/overlay/visible_edges.h"

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace wirepose::overlay {
namespace {

constexpr int kPiecesPerEdge = 32;
constexpr double kNearPlaneM = 0.01;
// An edge lies on its own faces: only what is nearer by more than this share of the diameter hides
// it.
constexpr double kSurfaceTolerance = 1e-3;

// Distance along the ray from the origin through `p`, in units of |p|, at which it meets the
// triangle (Moeller and Trumbore 1997), both sides counting. Border hits count.
std::optional<double> Intersect(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d e1 = b - a;
  const Vector3d e2 = c - a;
  const Vector3d h = p.cross(e2);
  const double det = e1.dot(h);
  if (std::abs(det) < 1e-15) return std::nullopt;
  const double u = -a.dot(h) / det;
  if (u < 0 || u > 1) return std::nullopt;
  const Vector3d q = (-a).cross(e1);
  const double v = p.dot(q) / det;
  if (v < 0 || u + v > 1) return std::nullopt;
  return e2.dot(q) / det;
}

bool IsHidden(const ModelView& model, const std::vector<Vector3d>& vertices, const Vector3d& p) {
  const double tolerance = kSurfaceTolerance * static_cast<double>(model.diameter_m) / p.norm();
  for (const ModelTriangle& t : model.triangles) {
    const auto hit = Intersect(p, vertices[t.vertex[0]], vertices[t.vertex[1]], vertices[t.vertex[2]]);
    if (hit && *hit > 0 && *hit < 1 - tolerance) return true;
  }
  return false;
}

}  // namespace

std::vector<EdgePiece> CutEdges(const ModelView& model, const Pose& T_camera_model) {
  std::vector<Vector3d> vertices;
  for (std::size_t i = 0; i < model.vertices.size(); ++i) {
    vertices.push_back(T_camera_model * model.VertexPosition(i).cast<double>());
  }
  std::vector<EdgePiece> pieces;
  for (std::uint16_t e = 0; e < model.edges.size(); ++e) {
    const Vector3d& a = vertices[model.edges[e].vertex[0]];
    const Vector3d step = (vertices[model.edges[e].vertex[1]] - a) / kPiecesPerEdge;
    bool joins = false;  // the previous part was drawn and can be extended
    for (int i = 0; i < kPiecesPerEdge; ++i) {
      const Vector3d from = a + i * step;
      const Vector3d to = a + (i + 1) * step;
      if (from.z() < kNearPlaneM || to.z() < kNearPlaneM) {
        joins = false;
        continue;
      }
      const bool hidden = IsHidden(model, vertices, 0.5 * (from + to));
      if (joins && pieces.back().hidden == hidden) {
        pieces.back().b = to;
      } else {
        pieces.push_back({e, hidden, from, to});
      }
      joins = true;
    }
  }
  return pieces;
}

}  // namespace wirepose::overlay
