#include "tools/model_compiler/aspects.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>

#include "tools/model_compiler/edge_map.h"

namespace wirepose::tools {
namespace {

using Eigen::Vector3d;

struct RtcRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

// The mesh in Embree. One thread, robust mode: the same bits on every run.
class Occluder {
 public:
  explicit Occluder(const mesh::Mesh& mesh) : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_.get())) {
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices.size()));
    for (const Vector3d& v : mesh.vertices) {
      for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(v[k]);
    }
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
      for (const int v : t) *indices++ = static_cast<unsigned>(v);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
  }

  // Is anything between `from` and a point `gap` before `to`?
  [[nodiscard]] bool Blocks(const Vector3d& from, const Vector3d& to, double gap) const {
    const double distance = (to - from).norm();
    const Vector3d direction = (to - from) / distance;
    RTCRay ray{};
    ray.org_x = static_cast<float>(from.x());
    ray.org_y = static_cast<float>(from.y());
    ray.org_z = static_cast<float>(from.z());
    ray.dir_x = static_cast<float>(direction.x());
    ray.dir_y = static_cast<float>(direction.y());
    ray.dir_z = static_cast<float>(direction.z());
    ray.tfar = static_cast<float>(distance - gap);
    ray.mask = 0xFFFFFFFFU;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_.get(), &context, &ray);
    return ray.tfar < 0;
  }

 private:
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, RtcRelease> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, RtcRelease> scene_;
};

bool FacesCamera(const Face& face, const Vector3d& camera) { return face.normal.dot(camera - face.centroid) > 0; }

bool CanBeSeen(const std::vector<Face>& faces, const Crease& crease, const Vector3d& camera) {
  if (crease.face[1] == kOpen) return true;
  return FacesCamera(faces[crease.face[0]], camera) || FacesCamera(faces[crease.face[1]], camera);
}

}  // namespace

std::vector<Vector3d> SphereDirections(int subdivisions) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vector3d> points{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                               {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vector3d& p : points) p.normalize();
  std::vector<std::array<int, 3>> triangles{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                            {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                            {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                            {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int s = 0; s < subdivisions; ++s) {
    std::map<EdgeKey, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [it, is_new] = middles.try_emplace(MakeEdgeKey(a, b), static_cast<int>(points.size()));
      if (is_new) points.push_back((points[a] + points[b]).normalized());
      return it->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& t : triangles) {
      const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  return points;
}

Vector3d EdgeSample(const mesh::Mesh& mesh, const Crease& crease, int k) {
  const double s = (k + 0.5) / kSamplesPerEdge;
  return (1 - s) * mesh.vertices[crease.vertex[0]] + s * mesh.vertices[crease.vertex[1]];
}

std::vector<Aspect> TraceAspects(const mesh::Mesh& mesh, const std::vector<Face>& faces,
                                 const std::vector<Crease>& creases, double diameter, double tolerance) {
  Vector3d low = mesh.vertices.at(0), high = low;
  for (const Vector3d& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const Vector3d centre = (low + high) / 2;
  const Occluder occluder(mesh);
  std::vector<Aspect> aspects;
  for (const Vector3d& direction : SphereDirections(2)) {
    Aspect aspect{direction, kAspectDistance * diameter, std::vector<int>(creases.size(), 0)};
    const Vector3d camera = centre + aspect.distance * direction;
    for (std::size_t e = 0; e < creases.size(); ++e) {
      if (!CanBeSeen(faces, creases[e], camera)) continue;
      for (int k = 0; k < kSamplesPerEdge; ++k) {
        if (!occluder.Blocks(camera, EdgeSample(mesh, creases[e], k), tolerance)) ++aspect.visible_samples[e];
      }
    }
    aspects.push_back(std::move(aspect));
  }
  return aspects;
}

}  // namespace wirepose::tools
