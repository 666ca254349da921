#include "sim/ray_scene.h"

#include <cstring>
#include <limits>

namespace wirepose::sim {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

RTCGeometry MakeGeometry(RTCDevice device, const Mesh& mesh, const Pose& T_world_object) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
  for (const Vector3& vertex : mesh.vertices) {
    const Vector3 world = (T_world_object * vertex.cast<double>()).cast<float>();
    for (int i = 0; i < 3; ++i) *vertices++ = world[i];
  }
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(std::uint32_t), mesh.triangles.size());
  std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * sizeof mesh.triangles[0]);
  rtcCommitGeometry(geometry);
  return geometry;
}

RTCScene MakeScene(RTCDevice device) {
  RTCScene scene = rtcNewScene(device);
  // Robust: a ray through a shared edge hits one of the two triangles for sure.
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  return scene;
}

RTCRay MakeRay(const Vector3& origin, const Vector3& direction) {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tfar = kFar;
  ray.mask = ~0U;
  return ray;
}

}  // namespace

RayScene::RayScene(const Scene& scene) : device_(rtcNewDevice("threads=1,set_affinity=0")), all_(MakeScene(device_)) {
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    RTCGeometry geometry = MakeGeometry(device_, mesh, instance.T_world_object);
    rtcAttachGeometryByID(all_, geometry, static_cast<unsigned>(i));
    alone_.push_back(nullptr);
    if (instance.obj_id > 0) {
      alone_.back() = MakeScene(device_);
      rtcAttachGeometryByID(alone_.back(), geometry, static_cast<unsigned>(i));
      rtcCommitScene(alone_.back());
    }
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(all_);
}

RayScene::~RayScene() {
  for (RTCScene scene : alone_) {
    if (scene != nullptr) rtcReleaseScene(scene);
  }
  rtcReleaseScene(all_);
  rtcReleaseDevice(device_);
}

RayScene::Hit RayScene::Intersect(const Vector3& origin, const Vector3& direction) const {
  RTCRayHit query{};
  query.ray = MakeRay(origin, direction);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(all_, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {static_cast<int>(query.hit.geomID), query.ray.tfar, {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z}};
}

bool RayScene::IsHidden(const Vector3& origin, const Vector3& direction) const {
  constexpr float kShort = 0.9999F;  // of the way: what is looked at does not hide itself
  RTCRay ray = MakeRay(origin, direction);
  ray.tfar = kShort;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(all_, &context, &ray);
  return ray.tfar < 0;
}

bool RayScene::MeetsAlone(int instance, const Vector3& origin, const Vector3& direction) const {
  RTCRay ray = MakeRay(origin, direction);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(alone_[static_cast<std::size_t>(instance)], &context, &ray);
  return ray.tfar < 0;
}

void RayScene::Intersect(const int* valid, RTCRayHit16& rays) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, all_, &context, &rays);
}

void RayScene::Occluded(const int* valid, RTCRay16& rays) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, all_, &context, &rays);
}

}  // namespace wirepose::sim
