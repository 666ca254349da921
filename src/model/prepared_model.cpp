#include "model/prepared_model.h"

#include <algorithm>
#include <cmath>

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
        if (Carries(model.symmetries[s], model.edges[f], model.edges[e], tolerance))
          model.edges[e].representative = false;
      }
    }
  }
}

// Every vertex lies behind the face.
bool IsOnHull(const ModelView& view, const ModelFace& face) {
  const float tolerance = 0.002F * view.diameter_m;
  const Vector3 normal(face.normal[0], face.normal[1], face.normal[2]);
  for (std::size_t v = 0; v < view.vertices.size(); ++v) {
    if (normal.dot(view.VertexPosition(v)) > face.offset_m + tolerance) return false;
  }
  return true;
}

bool IsConvex(const ModelView& view) {
  return std::all_of(view.faces.begin(), view.faces.end(), [&](const ModelFace& f) { return IsOnHull(view, f); });
}

// Mean of the corners of a face's triangles.
Vector3 CentreOf(const ModelView& view, const ModelFace& face) {
  Vector3 sum = Vector3::Zero();
  for (const ModelTriangle& triangle : view.triangles.subspan(face.first_triangle, face.triangle_count)) {
    for (const std::uint16_t v : triangle.vertex) sum += view.VertexPosition(v);
  }
  return sum / (3 * static_cast<float>(std::max<std::uint16_t>(face.triangle_count, 1)));
}

// The largest ones, by falling area.
void FindFeet(PreparedModel& model) {
  const auto& faces = model.view.faces;
  std::array<std::uint16_t, kMaxModelFaces> order;
  std::size_t count = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (IsOnHull(model.view, faces[f])) order[count++] = static_cast<std::uint16_t>(f);
  }
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(order.begin(), end, [&](std::uint16_t f, std::uint16_t g) {
    return faces[f].area_m2 != faces[g].area_m2 ? faces[f].area_m2 > faces[g].area_m2 : f < g;
  });
  model.feet.clear();
  for (auto f = order.begin(); f != end && !model.feet.full(); ++f)
    model.feet.push_back({*f, CentreOf(model.view, faces[*f])});
}

constexpr int kCells = PreparedModel::kCells;

// The cell of the unit cube's surface through which a direction leaves.
std::size_t CellOf(const Vector3& d) {
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(d[i]) > std::abs(d[axis])) axis = i;
  }
  const float scale = std::abs(d[axis]) > 0 ? 1 / std::abs(d[axis]) : 0;
  const auto cell = [&](int i) {
    return std::clamp(static_cast<int>((d[(axis + i) % 3] * scale + 1) * 0.5F * kCells), 0, kCells - 1);
  };
  const int face = 2 * axis + (d[axis] > 0 ? 1 : 0);
  return static_cast<std::size_t>((face * kCells + cell(1)) * kCells + cell(2));
}

// The middle of a cell; inverse of CellOf.
Vector3 DirectionOf(std::size_t cell) {
  const auto c = static_cast<int>(cell);
  const int face = c / (kCells * kCells);
  Vector3 d;
  d[face / 2] = face % 2 != 0 ? 1.0F : -1.0F;
  d[(face / 2 + 1) % 3] = (static_cast<float>(c / kCells % kCells) + 0.5F) * 2 / kCells - 1;
  d[(face / 2 + 2) % 3] = (static_cast<float>(c % kCells) + 0.5F) * 2 / kCells - 1;
  return d;
}

void IndexAspects(PreparedModel& model) {
  for (std::size_t cell = 0; cell < model.nearest_aspect.size(); ++cell) {
    const Vector3 d = DirectionOf(cell);
    float best = -1e9F;
    for (std::size_t a = 0; a < model.view.aspects.size(); ++a) {
      const auto& direction = model.view.aspects[a].direction;
      const float cosine = d.dot(Vector3(direction[0], direction[1], direction[2]));
      if (cosine <= best) continue;
      best = cosine;
      model.nearest_aspect[cell] = static_cast<std::uint8_t>(a);
    }
  }
}

// The end of the base edge at which the other edge meets it: 0 a, 1 b; 2: nowhere.
std::uint8_t SharedEnd(const PreparedModel& model, const PreparedEdge& base, const PreparedEdge& other) {
  const float limit = 0.02F * model.view.diameter_m;
  const auto near = [&](const Vector3& p, const Vector3& q) { return (p - q).squaredNorm() < limit * limit; };
  if (near(base.b, other.a) || near(base.b, other.b)) return 1;
  return near(base.a, other.a) || near(base.a, other.b) ? 0 : 2;
}

// Sets of representative base edges, members at a corner first, each part by rising distance.
void PrepareSets(PreparedModel& model) {
  model.sets.clear();
  model.members.clear();
  for (const ModelLineSet& set : model.view.line_sets) {
    const PreparedEdge& base = model.edges[set.base_edge];
    if (!base.representative) continue;
    const std::size_t first = model.members.size();
    for (const ModelSetMember& member : model.view.set_members.subspan(set.first_member, set.member_count)) {
      const PreparedEdge& other = model.edges[member.edge];
      model.members.push_back(
          {member.distance_m, member.angle_rad, member.farthest_end_m, member.edge, SharedEnd(model, base, other)});
    }
    const auto begin = model.members.begin() + first;
    std::sort(begin, model.members.end(), [](const PreparedMember& p, const PreparedMember& q) {
      if ((p.base_end == 2) != (q.base_end == 2)) return q.base_end == 2;
      return p.distance_m != q.distance_m ? p.distance_m < q.distance_m : p.other_edge < q.other_edge;
    });
    const auto corner_end =
        std::find_if(begin, model.members.end(), [](const PreparedMember& m) { return m.base_end == 2; });
    PreparedSet prepared{set.kind, set.base_edge, static_cast<std::uint16_t>(first),
                         static_cast<std::uint16_t>(corner_end - model.members.begin()),
                         static_cast<std::uint16_t>(model.members.size())};
    for (auto m = begin; m != model.members.end(); ++m) {
      prepared.max_distance_m = std::max(prepared.max_distance_m, m->distance_m);
      prepared.max_farthest_end_m = std::max(prepared.max_farthest_end_m, m->farthest_end_m);
    }
    model.sets.push_back(prepared);
  }
}

}  // namespace

bool PreparedModel::FacesEye(std::size_t edge, const Vector3& eye) const {
  const ModelEdge& e = view.edges[edge];
  // A boundary edge of an open mesh is seen from both sides.
  return e.face[1] == kNoFace || IsTowards(view.faces[e.face[0]], eye) || IsTowards(view.faces[e.face[1]], eye);
}

const EdgeBits& PreparedModel::EdgesSeenFrom(const Vector3& eye) const {
  return view.aspects[nearest_aspect[CellOf(eye - centre)]].visible_edges;
}

EdgeBits PreparedModel::VisibleEdges(const Vector3& eye) const {
  EdgeBits bits = EdgesSeenFrom(eye);
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
  out.max_centre_shift_m = 0;
  for (const Pose& s : out.symmetries) {
    const Vector3 carried = (s * out.centre.cast<double>()).cast<float>();
    out.max_centre_shift_m = std::max(out.max_centre_shift_m, (carried - out.centre).norm());
  }
  for (std::size_t i = 0; i < out.corners.size(); ++i) {
    out.corners[i] = {(i & 1U) != 0 ? view.box_max_m.x() : view.box_min_m.x(),
                      (i & 2U) != 0 ? view.box_max_m.y() : view.box_min_m.y(),
                      (i & 4U) != 0 ? view.box_max_m.z() : view.box_min_m.z()};
  }
  out.convex = IsConvex(view);
  FindFeet(out);
  MarkRepresentatives(out);
  PrepareSets(out);
  IndexAspects(out);
}

}  // namespace wirepose
