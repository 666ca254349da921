#include "tools/model_compiler/line_sets.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace wirepose::tools {
namespace {

using Eigen::Vector3d;

struct LineSegment {
  Vector3d a, b;
  [[nodiscard]] Vector3d Direction() const { return (b - a).normalized(); }
};

LineSegment SegmentOf(const mesh::Mesh& mesh, const Crease& c) {
  return {mesh.vertices[c.vertex[0]], mesh.vertices[c.vertex[1]]};
}

// Between directions, whose sign means nothing: 0..pi/2.
double LineAngle(const LineSegment& s, const LineSegment& o) {
  const Vector3d d = s.Direction(), e = o.Direction();
  return std::atan2(d.cross(e).norm(), std::abs(d.dot(e)));
}

double ParallelDistance(const LineSegment& base, const LineSegment& o) {
  return base.Direction().cross((o.a + o.b) / 2 - base.a).norm();
}

double CommonPerpendicular(const LineSegment& s, const LineSegment& o) {
  return std::abs(s.Direction().cross(o.Direction()).normalized().dot(o.a - s.a));
}

int CommonFaces(const Crease& c, const Crease& o) {
  int count = 0;
  for (const int f : c.face) {
    if (f != kOpen && (f == o.face[0] || f == o.face[1])) ++count;
  }
  return count;
}

ModelLineSet DescribeSet(const std::vector<Crease>& creases, LineSetKind kind, int base, std::size_t first_member,
                         const std::vector<ModelSetMember>& members) {
  std::set<int> touched(creases[base].face.begin(), creases[base].face.end());
  for (const ModelSetMember& m : members) touched.insert(creases[m.edge].face.begin(), creases[m.edge].face.end());
  touched.erase(kOpen);
  return {kind, static_cast<std::uint16_t>(base), static_cast<std::uint16_t>(touched.size()),
          static_cast<std::uint32_t>(first_member), static_cast<std::uint32_t>(members.size())};
}

// The longest creases that at least one aspect shows.
std::vector<int> BaseLines(const std::vector<std::vector<bool>>& co_visible) {
  std::vector<int> bases;
  for (std::size_t e = 0; e < co_visible.size() && bases.size() < kMaxLineSetEdges; ++e) {
    if (co_visible[e][e]) bases.push_back(static_cast<int>(e));
  }
  return bases;
}

}  // namespace

ModelSetMember ParameterVector(const mesh::Mesh& mesh, const std::vector<Crease>& creases, int base, int member,
                               double parallel_angle_rad) {
  const LineSegment s = SegmentOf(mesh, creases[base]), o = SegmentOf(mesh, creases[member]);
  const double angle = LineAngle(s, o);
  const double distance = angle <= parallel_angle_rad ? ParallelDistance(s, o) : CommonPerpendicular(s, o);
  const auto [nearest, farthest] =
      std::minmax({(s.a - o.a).norm(), (s.a - o.b).norm(), (s.b - o.a).norm(), (s.b - o.b).norm()});
  return {static_cast<std::uint16_t>(member), static_cast<std::uint16_t>(CommonFaces(creases[base], creases[member])),
          static_cast<float>(angle),          static_cast<float>(distance),
          static_cast<float>(nearest),        static_cast<float>(farthest)};
}

LineSets MakeLineSets(const mesh::Mesh& mesh, const std::vector<Crease>& creases,
                      const std::vector<std::vector<bool>>& co_visible, double parallel_angle_rad) {
  LineSets result;
  const std::vector<int> bases = BaseLines(co_visible);
  for (const int base : bases) {
    std::vector<ModelSetMember> parallel, intersecting;
    for (const int other : bases) {
      if (other == base || !co_visible[base][other]) continue;
      const ModelSetMember v = ParameterVector(mesh, creases, base, other, parallel_angle_rad);
      (static_cast<double>(v.angle_rad) <= parallel_angle_rad ? parallel : intersecting).push_back(v);
    }
    for (const auto kind : {LineSetKind::kParallel, LineSetKind::kIntersecting}) {
      auto& members = kind == LineSetKind::kParallel ? parallel : intersecting;
      if (members.empty()) continue;
      std::stable_sort(members.begin(), members.end(),
                       [](const auto& a, const auto& b) { return a.nearest_end_m < b.nearest_end_m; });
      result.sets.push_back(DescribeSet(creases, kind, base, result.members.size(), members));
      result.members.insert(result.members.end(), members.begin(), members.end());
    }
  }
  return result;
}

}  // namespace wirepose::tools
