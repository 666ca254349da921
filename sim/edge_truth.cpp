#include "sim/edge_truth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "sim/lens.h"

namespace wirepose::sim {
namespace {

constexpr double kSharp = 20 * std::numbers::pi / 180;
constexpr double kNear = 0.02;  // m before the camera: nothing closer is projected

using Key = std::array<long, 3>;

Key KeyOf(const Vector3& v) {
  constexpr float kPerMetre = 1e6F;
  return {std::lround(v.x() * kPerMetre), std::lround(v.y() * kPerMetre), std::lround(v.z() * kPerMetre)};
}

// The two ends of an edge and the normals of the faces that meet there.
struct Meeting {
  std::array<Vector3d, 2> ends;
  std::vector<Vector3d> normals;
};

bool IsSharp(const Meeting& m) {
  if (m.normals.size() == 1) return true;
  for (std::size_t i = 1; i < m.normals.size(); ++i) {
    if (m.normals[0].dot(m.normals[i]) < std::cos(kSharp)) return true;
  }
  return false;
}

// The image of points of the world; nothing behind the camera, outside of the image or beyond the
// lens's fold.
class Projection {
 public:
  explicit Projection(const Camera& camera)
      : camera_(camera), lens_(camera.intrinsics), T_camera_world_(camera.T_world_camera.Inverse()) {}

  [[nodiscard]] std::optional<Vector2d> operator()(const Vector3d& world) const {
    const Vector3d p = T_camera_world_ * world;
    if (p.z() < kNear) return std::nullopt;
    const Vector2d xy(p.x() / p.z(), p.y() / p.z()), pixel = lens_.PixelOf(xy);
    if (pixel.x() < -0.5 || pixel.y() < -0.5 || pixel.x() > camera_.width - 0.5 || pixel.y() > camera_.height - 0.5) {
      return std::nullopt;
    }
    const std::optional<Lens::Ray> seen = lens_.RayOf(pixel);
    return seen && (seen->xy - xy).norm() < 1e-6 ? std::optional(pixel) : std::nullopt;
  }

  // Length in pixels if the lens were ideal, for choosing a step.
  [[nodiscard]] double Length(const Vector3d& a, const Vector3d& b) const {
    const Vector3d p = T_camera_world_ * a, q = T_camera_world_ * b;
    if (p.z() < kNear || q.z() < kNear) return 2.0 * camera_.width;
    return camera_.intrinsics.fx * std::hypot(p.x() / p.z() - q.x() / q.z(), p.y() / p.z() - q.y() / q.z());
  }

 private:
  const Camera& camera_;
  Lens lens_;
  Pose T_camera_world_;
};

}  // namespace

std::vector<std::array<Vector3d, 2>> SharpEdges(const Mesh& mesh) {
  std::map<std::pair<Key, Key>, Meeting> meetings;
  std::vector<std::pair<Key, Key>> order;
  for (const auto& t : mesh.triangles) {
    const std::array<Vector3, 3> v = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    const Vector3d cross = (v[1] - v[0]).cross(v[2] - v[0]).cast<double>();
    if (cross.norm() < 1e-14) continue;  // no area, no direction
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 &a = v[i], &b = v[(i + 1) % 3];
      std::pair<Key, Key> key{KeyOf(a), KeyOf(b)};
      if (key.second < key.first) std::swap(key.first, key.second);
      const auto [at, is_new] = meetings.try_emplace(key);
      if (is_new) {
        at->second.ends = {a.cast<double>(), b.cast<double>()};
        order.push_back(key);
      }
      at->second.normals.push_back(cross.normalized());
    }
  }
  std::vector<std::array<Vector3d, 2>> edges;
  for (const auto& key : order) {
    const Meeting& meeting = meetings.at(key);
    if (IsSharp(meeting)) edges.push_back(meeting.ends);
  }
  return edges;
}

std::vector<dataset::EdgePart> VisibleEdgeParts(const Renderer& renderer, const Camera& camera, int instance,
                                                double step_px) {
  const Instance& object = renderer.scene().instances[static_cast<std::size_t>(instance)];
  const Projection project(camera);
  const Vector3d eye = camera.T_world_camera.t;
  std::vector<dataset::EdgePart> parts;
  int index = 0;
  for (const auto& edge : SharpEdges(renderer.scene().meshes[static_cast<std::size_t>(object.mesh)])) {
    const Vector3d a = object.T_world_object * edge[0], b = object.T_world_object * edge[1];
    const int steps = std::max(1, static_cast<int>(std::ceil(project.Length(a, b) / step_px)));
    bool is_open = false;
    for (int i = 0; i <= steps; ++i) {
      const double at = static_cast<double>(i) / steps;
      const Vector3d p = a + at * (b - a);
      const std::optional<Vector2d> pixel = project(p);
      const bool is_seen = pixel && !renderer.rays().IsHidden(eye.cast<float>(), (p - eye).cast<float>());
      if (is_seen && !is_open) parts.push_back({index, at, at, {pixel->x(), pixel->y(), pixel->x(), pixel->y()}});
      if (is_seen) {
        parts.back().to = at;
        parts.back().pixels[2] = pixel->x();
        parts.back().pixels[3] = pixel->y();
      }
      is_open = is_seen;
    }
    ++index;
  }
  // A single place is no part of an edge.
  std::erase_if(parts, [](const dataset::EdgePart& part) { return part.from == part.to; });
  return parts;
}

}  // namespace wirepose::sim
