// Rooms: what stands fixed around the place where objects are put down. Used inside this room only.
// World frame: x along the back wall, y towards it, z up, origin in the middle of the worktop, m.
#ifndef WIREPOSE_SIM_ROOM_H_
#define WIREPOSE_SIM_ROOM_H_

#include "sim/scene_builder.h"

namespace wirepose::sim {

// A rectangle on which things stand.
struct Place {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero(), half = Eigen::Vector2d::Zero();
  double z = 0;
  float albedo = 0.5F;
};

struct Room {
  Place worktop;  // z = 0
  Place floor;    // a bay as wide as a refrigerator, back to the wall
  double floor_z = -0.9, ceiling_z = 1.6;
  std::vector<Place> boards;  // shelves that hold clutter only
  double wall_y = 0;          // of the wall behind the worktop
  bool has_wall_cabinets = false;
};

// `needs_bay`: something stands on the floor beside the counter.
[[nodiscard]] Room BuildRoom(Random& random, const RoomSpec& spec, bool needs_bay, SceneBuilder& builder);

void AddLights(Random& random, const LightSpec& spec, const Room& room, Scene& scene);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_ROOM_H_
