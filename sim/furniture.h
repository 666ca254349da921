// Kitchen furniture: cabinets with doors, drawers and handles, tables, chairs, shelves. Used inside
// this room only. World frame: x along the wall, y towards it, z up, metres.
#ifndef WIREPOSE_SIM_FURNITURE_H_
#define WIREPOSE_SIM_FURNITURE_H_

#include "sim/scene_builder.h"

namespace wirepose::sim {

// The surfaces that all cabinets of one kitchen share.
struct KitchenStyle {
  Material worktop, front, handle, carcass;
  bool is_framed = false;       // shaker fronts: a raised frame around a panel
  bool has_bar_handles = true;  // else knobs
};

// Where a row of cabinets stands: from x0 to x1, its back at the wall.
struct Row {
  double x0 = 0, x1 = 0;
  double wall_y = 0;
  double top_z = 0;  // of the worktop
  double floor_z = 0;
};

inline constexpr double kRowDepth = 0.62;  // of base cabinets

void BuildBaseCabinets(Random& random, const KitchenStyle& style, const Row& row, SceneBuilder& builder);
// From `low_z` to `high_z` above the worktop.
void BuildWallCabinets(Random& random, const KitchenStyle& style, const Row& row, double low_z, double high_z,
                       SceneBuilder& builder);

// A board with legs; its top at z = 0.
void BuildTable(const Vector3d& half, double floor_z, const Material& top, const Material& legs, SceneBuilder& builder);
// `at` is the middle of the seat's shadow on the floor; it faces along -y turned by `yaw_rad`.
void BuildChair(const Vector3d& at, double yaw_rad, const Material& material, SceneBuilder& builder);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_FURNITURE_H_
