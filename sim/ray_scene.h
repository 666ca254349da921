// The scene as Embree sees it. Used inside this room only.
#ifndef WIREPOSE_SIM_RAY_SCENE_H_
#define WIREPOSE_SIM_RAY_SCENE_H_

#include <embree3/rtcore.h>

#include <memory>
#include <vector>

#include "sim/scene.h"

namespace wirepose::sim {

// Every instance is one Embree geometry in world coordinates, so a hit's geomID is the index of the
// instance. Queries may run on many threads at once. Rays are o + t d with any length of d.
class RayScene {
 public:
  static constexpr int kPacket = 16;  // rays traced together
  static constexpr int kNothing = -1;

  explicit RayScene(const Scene& scene);
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;
  ~RayScene();

  struct Hit {
    int instance = kNothing;
    float t = 0;
    Vector3 normal = Vector3::Zero();  // of any length, to either side
  };
  // The nearest surface along one ray.
  [[nodiscard]] Hit Intersect(const Vector3& origin, const Vector3& direction) const;
  // Is there anything between the origin and origin + direction?
  [[nodiscard]] bool IsHidden(const Vector3& origin, const Vector3& direction) const;
  // Does the ray meet this instance when nothing else is there?
  [[nodiscard]] bool MeetsAlone(int instance, const Vector3& origin, const Vector3& direction) const;

  // As Embree's packet functions; `valid` holds -1 for the lanes to trace and 0 for the others.
  void Intersect(const int* valid, RTCRayHit16& rays) const;
  void Occluded(const int* valid, RTCRay16& rays) const;

 private:
  RTCDevice device_;
  RTCScene all_;
  std::vector<RTCScene> alone_;  // one scene an instance that has truth, else null
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_RAY_SCENE_H_
