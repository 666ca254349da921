// What every parsed model promises, checked the slow and obvious way. For parser, compiler and fuzz
// tests.
#ifndef WIREPOSE_TESTS_MODEL_MODEL_CONSISTENCY_H_
#define WIREPOSE_TESTS_MODEL_MODEL_CONSISTENCY_H_

#include <algorithm>
#include <cmath>

#include "model/model_view.h"

namespace wirepose::testing {

// The first promise of ModelView that `m` breaks, or null. Touches every record, so that a
// sanitizer sees a span that leaves the file.
inline const char* FindInconsistency(const ModelView& m) {
  if (m.name.empty() || m.name.size() >= kMaxModelName) return "name";
  if (!(m.diameter_m > 0) || !std::isfinite(m.diameter_m)) return "diameter";
  if (m.vertices.empty() || m.vertices.size() > kMaxModelVertices) return "vertex count";
  if (m.triangles.empty() || m.triangles.size() > kMaxModelTriangles) return "triangle count";
  if (m.faces.empty() || m.faces.size() > kMaxModelFaces) return "face count";
  if (m.edges.empty() || m.edges.size() > kMaxModelEdges) return "edge count";
  if (m.line_sets.size() > kMaxModelLineSets || m.set_members.size() > kMaxModelSetMembers) return "set counts";
  if (m.symmetries.size() >= kMaxModelSymmetries || m.aspects.size() > kMaxModelAspects) return "other counts";
  for (std::size_t v = 0; v < m.vertices.size(); ++v) {
    if (!m.VertexPosition(v).allFinite()) return "vertex";
  }
  for (const ModelTriangle& t : m.triangles) {
    if (std::max({t.vertex[0], t.vertex[1], t.vertex[2]}) >= m.vertices.size()) return "triangle vertex";
    if (t.face >= m.faces.size()) return "triangle face";
  }
  std::size_t triangles = 0;
  for (std::size_t f = 0; f < m.faces.size(); ++f) {
    const ModelFace& face = m.faces[f];
    if (std::abs(Vector3(face.normal).norm() - 1) > 1e-3F) return "face normal";
    if (!std::isfinite(face.offset_m) || !(face.area_m2 > 0)) return "face plane";
    for (std::size_t t = 0; t < face.triangle_count; ++t) {
      if (m.triangles[face.first_triangle + t].face != f) return "face range";
    }
    triangles += face.triangle_count;
  }
  if (triangles != m.triangles.size()) return "triangles without face";
  for (std::size_t e = 0; e < m.edges.size(); ++e) {
    const ModelEdge& edge = m.edges[e];
    if (std::max(edge.vertex[0], edge.vertex[1]) >= m.vertices.size()) return "edge vertex";
    if (edge.face[0] >= m.faces.size()) return "edge face";
    if (edge.face[1] >= m.faces.size() && edge.face[1] != kNoFace) return "edge face";
    if (!(edge.length_m > 0) || !(edge.dihedral_rad >= 0 && edge.dihedral_rad < 3.15F)) return "edge numbers";
    if (e > 0 && edge.length_m > m.edges[e - 1].length_m) return "edge order";
  }
  for (const ModelLineSet& s : m.line_sets) {
    if (s.kind != LineSetKind::kParallel && s.kind != LineSetKind::kIntersecting) return "set kind";
    if (s.base_edge >= m.edges.size() || s.member_count == 0) return "set base";
    if (s.first_member + s.member_count > m.set_members.size()) return "set range";
  }
  for (const ModelSetMember& s : m.set_members) {
    if (s.edge >= m.edges.size() || s.common_faces > 2) return "member index";
    if (!(s.angle_rad >= 0 && s.angle_rad < 1.6F && s.distance_m >= 0)) return "member numbers";
    if (!(s.nearest_end_m >= 0 && s.farthest_end_m >= s.nearest_end_m)) return "member ends";
  }
  for (const ModelSymmetry& s : m.symmetries) {
    const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> R(s.rotation);
    if ((R * R.transpose() - Matrix3::Identity()).norm() > 1e-2F || R.determinant() < 0.9F) return "symmetry rotation";
    if (!Vector3(s.translation_m).allFinite()) return "symmetry translation";
  }
  for (const ModelAspect& a : m.aspects) {
    if (std::abs(Vector3(a.direction).norm() - 1) > 1e-3F || !(a.distance_m > 0)) return "aspect camera";
    for (std::size_t e = m.edges.size(); e < kMaxModelEdges; ++e) {
      if ((a.visible_edges[e / 32] >> (e % 32) & 1U) != 0) return "aspect bits";
    }
  }
  return nullptr;
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_MODEL_MODEL_CONSISTENCY_H_
