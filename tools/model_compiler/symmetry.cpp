#include "tools/model_compiler/symmetry.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace wirepose::tools {
namespace {

constexpr double kSameRotation_rad = 0.5 * M_PI / 180;  // below it two candidates are one

// The object as far as symmetry cares, seen from its centre of area, which every symmetry leaves in
// place.
struct Shape {
  struct Segment {
    Vector3d a, b;
    [[nodiscard]] Vector3d Middle() const { return (a + b) / 2; }
  };
  Vector3d centre;
  std::vector<Segment> segments;
  std::vector<Face> faces;
};

Shape MakeShape(const mesh::Mesh& mesh, const std::vector<Face>& faces, const std::vector<Crease>& creases) {
  Shape shape{Vector3d::Zero(), {}, faces};
  double area = 0;
  for (const Face& f : faces) {
    shape.centre += f.area * f.centroid;
    area += f.area;
  }
  shape.centre /= area;
  for (Face& f : shape.faces) f.centroid -= shape.centre;
  for (const Crease& c : creases) {
    shape.segments.push_back({mesh.vertices[c.vertex[0]] - shape.centre, mesh.vertices[c.vertex[1]] - shape.centre});
  }
  return shape;
}

bool MapsOntoItself(const Shape& shape, const Matrix3d& R, double tolerance) {
  const auto near = [&](const Vector3d& p, const Vector3d& q) { return (p - q).norm() <= tolerance; };
  for (const auto& s : shape.segments) {
    const Vector3d a = R * s.a, b = R * s.b;
    const bool found = std::any_of(shape.segments.begin(), shape.segments.end(), [&](const auto& other) {
      return (near(a, other.a) && near(b, other.b)) || (near(a, other.b) && near(b, other.a));
    });
    if (!found) return false;
  }
  for (const Face& f : shape.faces) {
    const Vector3d centroid = R * f.centroid, normal = R * f.normal;
    const bool found = std::any_of(shape.faces.begin(), shape.faces.end(), [&](const Face& other) {
      return near(centroid, other.centroid) && normal.dot(other.normal) > 0.999 &&
             std::abs(f.area - other.area) <= 0.01 * f.area + tolerance * tolerance;
    });
    if (!found) return false;
  }
  return true;
}

// Right-handed frame from a segment's middle and direction; none if they do not span a plane.
std::optional<Matrix3d> FrameOf(const Shape::Segment& s, bool reversed, double tolerance) {
  const Vector3d middle = s.Middle();
  const Vector3d direction = reversed ? Vector3d(s.a - s.b) : Vector3d(s.b - s.a);
  const Vector3d normal = middle.cross(direction);
  if (normal.norm() <= tolerance * direction.norm()) return std::nullopt;  // the line passes through the centre
  Matrix3d F;
  F.col(0) = direction.normalized();
  F.col(2) = normal.normalized();
  F.col(1) = F.col(2).cross(F.col(0));
  return F;
}

bool Alike(const Shape::Segment& s, const Shape::Segment& o, double tolerance) {
  if (std::abs((s.a - s.b).norm() - (o.a - o.b).norm()) > 2 * tolerance) return false;
  if (std::abs(s.Middle().norm() - o.Middle().norm()) > tolerance) return false;
  const auto radii = [](const Shape::Segment& x) { return std::minmax({x.a.norm(), x.b.norm()}); };
  const auto rs = radii(s), ro = radii(o);
  return std::abs(rs.first - ro.first) <= tolerance && std::abs(rs.second - ro.second) <= tolerance;
}

// A segment that few others resemble: every symmetry maps it onto one of those.
std::optional<std::size_t> RarestSegment(const Shape& shape, double tolerance) {
  std::optional<std::size_t> best;
  std::ptrdiff_t fewest = 0;
  for (std::size_t i = 0; i < shape.segments.size(); ++i) {
    if (!FrameOf(shape.segments[i], false, 10 * tolerance)) continue;
    const auto alike = std::count_if(shape.segments.begin(), shape.segments.end(),
                                     [&](const auto& o) { return Alike(shape.segments[i], o, tolerance); });
    if (best && alike >= fewest) continue;
    best = i;
    fewest = alike;
  }
  return best;
}

double AngleOf(const Matrix3d& R) { return Eigen::AngleAxisd(R).angle(); }

// Index of the rotation nearest to R if it is the same up to noise.
std::optional<int> Find(const std::vector<Matrix3d>& rotations, const Matrix3d& R) {
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    if (AngleOf(rotations[i].transpose() * R) < kSameRotation_rad) return static_cast<int>(i);
  }
  return std::nullopt;
}

// All symmetries; the identity comes first.
std::vector<Matrix3d> FindGroup(const Shape& shape, double tolerance) {
  std::vector<Matrix3d> group{Matrix3d::Identity()};
  const auto reference = RarestSegment(shape, tolerance);
  if (!reference) return group;
  const Matrix3d F = *FrameOf(shape.segments[*reference], false, 10 * tolerance);
  for (const auto& s : shape.segments) {
    if (!Alike(shape.segments[*reference], s, tolerance)) continue;
    for (const bool reversed : {false, true}) {
      const auto G = FrameOf(s, reversed, 5 * tolerance);
      if (!G) continue;
      const Matrix3d R = *G * F.transpose();
      if (!Find(group, R) && MapsOntoItself(shape, R, tolerance)) group.push_back(Orthonormalize(R));
    }
  }
  return group;
}

// The products of the generators, as indices into `group`; empty when they are more than `limit` or
// leave the group.
std::set<int> Closure(const std::vector<Matrix3d>& group, std::initializer_list<int> generators, std::size_t limit) {
  std::set<int> members{0};
  std::vector<int> pending{0};
  while (!pending.empty()) {
    const int m = pending.back();
    pending.pop_back();
    for (const int g : generators) {
      const auto product = Find(group, group[g] * group[m]);
      if (!product) return {};
      if (!members.insert(*product).second) continue;
      if (members.size() > limit) return {};
      pending.push_back(*product);
    }
  }
  return members;
}

std::set<int> LargestSubgroup(const std::vector<Matrix3d>& group, std::size_t limit) {
  std::set<int> best{0};
  const int n = static_cast<int>(group.size());
  for (int a = 1; a < n; ++a) {
    std::set<int> closure = Closure(group, {a}, limit);
    if (closure.size() > best.size()) best = std::move(closure);
  }
  const std::set<int> cyclic = best;
  if (cyclic.size() < 2) return best;
  for (const int a : cyclic) {  // a generator of the best cyclic group with any other element
    if (Closure(group, {a}, limit).size() != cyclic.size()) continue;
    for (int b = 1; b < n; ++b) {
      std::set<int> closure = Closure(group, {a, b}, limit);
      if (closure.size() > best.size()) best = std::move(closure);
    }
    break;
  }
  return best;
}

}  // namespace

Symmetries FindSymmetries(const mesh::Mesh& mesh, const std::vector<Face>& faces, const std::vector<Crease>& creases,
                          double tolerance, std::size_t capacity) {
  const Shape shape = MakeShape(mesh, faces, creases);
  std::vector<Matrix3d> group = FindGroup(shape, tolerance);
  Symmetries result;
  result.found = group.size() - 1;
  if (result.found > capacity) {
    std::vector<Matrix3d> kept;
    for (const int i : LargestSubgroup(group, capacity + 1)) kept.push_back(group[i]);
    group = std::move(kept);
  }
  for (std::size_t i = 1; i < group.size(); ++i) {
    result.poses.push_back({group[i], shape.centre - group[i] * shape.centre});
  }
  return result;
}

}  // namespace wirepose::tools
