#include "model/prepared_model.h"

namespace wirepose {
namespace {

Pose ToPose(const ModelSymmetry& s) {
  Pose pose;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose.R(r, c) = static_cast<double>(s.rotation[3 * r + c]);
    pose.t(r) = static_cast<double>(s.translation_m[r]);
  }
  pose.R = Orthonormalize(pose.R);
  return pose;
}

// True when the symmetry carries edge p onto edge q (in either direction).
bool Carries(const Pose& symmetry, const PreparedEdge& p, const PreparedEdge& q, float tolerance) {
  const Vector3 a = (symmetry * p.a.cast<double>()).cast<float>();
  const Vector3 b = (symmetry * p.b.cast<double>()).cast<float>();
  const auto near = [&](const Vector3& x, const Vector3& y) { return (x - y).squaredNorm() < tolerance * tolerance; };
  return (near(a, q.a) && near(b, q.b)) || (near(a, q.b) && near(b, q.a));
}

void MarkRepresentatives(PreparedModel& model) {
  const float tolerance = 0.01F * model.view.diameter_m;
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    for (std::size_t f = 0; f < e && model.edges[e].representative; ++f) {
      for (std::size_t s = 1; s < model.symmetries.size(); ++s) {
        if (Carries(model.symmetries[s], model.edges[f], model.edges[e], tolerance)) model.edges[e].representative = false;
      }
    }
  }
}

bool IsTowards(const ModelFace& face, const Vector3& eye) {
  return Vector3(face.normal[0], face.normal[1], face.normal[2]).dot(eye) > face.offset_m;
}

// Every vertex lies behind every face.
bool IsConvex(const ModelView& view) {
  const float tolerance = 0.002F * view.diameter_m;
  for (const ModelFace& face : view.faces) {
    const Vector3 normal(face.normal[0], face.normal[1], face.normal[2]);
    for (std::size_t v = 0; v < view.vertices.size(); ++v) {
      if (normal.dot(view.VertexPosition(v)) > face.offset_m + tolerance) return false;
    }
  }
  return true;
}

}  // namespace

bool PreparedModel::FacesEye(std::size_t edge, const Vector3& eye) const {
  const ModelEdge& e = view.edges[edge];
  // A boundary edge of an open mesh is seen from both sides.
  return e.face[1] == kNoFace || IsTowards(view.faces[e.face[0]], eye) || IsTowards(view.faces[e.face[1]], eye);
}

EdgeBits PreparedModel::VisibleEdges(const Vector3& eye) const {
  const Vector3 direction = eye - centre;
  const ModelAspect* nearest = nullptr;
  float best = 0;
  for (const ModelAspect& aspect : view.aspects) {
    const float cosine = direction.dot(Vector3(aspect.direction[0], aspect.direction[1], aspect.direction[2]));
    if (nearest != nullptr && cosine <= best) continue;
    best = cosine;
    nearest = &aspect;
  }
  EdgeBits bits{};
  if (nearest == nullptr) return bits;
  bits = nearest->visible_edges;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (!FacesEye(e, eye)) bits[e / 32] &= ~(1U << (e % 32));
  }
  return bits;
}

void PrepareModel(const ModelView& view, PreparedModel& out) {
  out.view = view;
  out.centre = 0.5F * (view.box_min_m + view.box_max_m);
  out.edges.clear();
  for (const ModelEdge& edge : view.edges) {
    PreparedEdge prepared;
    prepared.a = view.VertexPosition(edge.vertex[0]);
    prepared.b = view.VertexPosition(edge.vertex[1]);
    prepared.length_m = (prepared.b - prepared.a).norm();
    prepared.direction = (prepared.b - prepared.a) / prepared.length_m;
    out.edges.push_back(prepared);
  }
  out.symmetries.clear();
  out.symmetries.push_back(Pose{});
  for (const ModelSymmetry& s : view.symmetries) {
    if (!out.symmetries.try_push_back(ToPose(s))) break;
  }
  for (std::size_t i = 0; i < out.corners.size(); ++i) {
    out.corners[i] = {(i & 1U) != 0 ? view.box_max_m.x() : view.box_min_m.x(),
                      (i & 2U) != 0 ? view.box_max_m.y() : view.box_min_m.y(),
                      (i & 4U) != 0 ? view.box_max_m.z() : view.box_min_m.z()};
  }
  out.convex = IsConvex(view);
  MarkRepresentatives(out);
}

}  // namespace wirepose
