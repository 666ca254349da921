// Puts objects and clutter down without letting them touch. Used inside this room only.
#ifndef WIREPOSE_SIM_LAYOUT_H_
#define WIREPOSE_SIM_LAYOUT_H_

#include <string>
#include <vector>

#include "sim/clutter.h"
#include "sim/placement.h"
#include "sim/room.h"
#include "sim/target_mesh.h"

namespace wirepose::sim {

// One instance of a model that was put down.
struct Placed {
  int instance = 0;  // index into Scene::instances
  const ObjectSpec* spec = nullptr;
};

// Large things stand on the floor only.
[[nodiscard]] bool FitsOn(Support support, const TargetMesh& target);

class Layout {
 public:
  // Both must outlive it.
  Layout(Random& random, SceneBuilder& builder, const Room& room) : random_(random), builder_(builder), room_(room) {}

  // Puts down all instances that the specification asks for and that find room.
  void PlaceObjects(const std::vector<ObjectSpec>& specs, const std::vector<TargetMesh>& targets);
  // On worktop and boards.
  void PlaceClutter(const ClutterSpec& spec);
  // Between the eye and the first object.
  void PlaceOccluders(const ClutterSpec& spec, const Vector3d& eye);

  [[nodiscard]] const std::vector<Placed>& placed() const { return placed_; }

 private:
  struct Region {
    Range x, y;  // of the middle
    double z = 0;
    const Place* within = nullptr;
  };
  struct Standing {
    Footprint print;
    double z;
  };

  void PlaceObject(const ObjectSpec& spec, const TargetMesh& target);
  [[nodiscard]] Pose DrawPose(const PoseSpec& spec);
  bool PutDown(const Mesh& mesh, const RestingPose& rest, const Region& region, const Range& yaw_deg,
               const Material& material);
  [[nodiscard]] bool IsFree(const Footprint& print, const Region& region) const;
  [[nodiscard]] RestingPose DrawRest(const Mesh& mesh, Rest rest, bool is_cuboid);
  [[nodiscard]] const Place* SupportOf(const ObjectSpec& spec);
  [[nodiscard]] Material DrawMaterial(const ObjectSpec& spec, const std::string& name, const Mesh& mesh, float ground);

  Random& random_;
  SceneBuilder& builder_;
  const Room& room_;
  Place refrigerator_top_;
  std::vector<Standing> standing_;
  std::vector<Placed> placed_;
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_LAYOUT_H_
