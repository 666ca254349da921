// Where things can stand on a table. World frame: z up, table top at z = 0, metres.
#ifndef WIREPOSE_SIM_PLACEMENT_H_
#define WIREPOSE_SIM_PLACEMENT_H_

#include <vector>

#include "sim/mesh.h"

namespace wirepose::sim {

// The rectangle on the table below an object.
struct Footprint {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d half = Eigen::Vector2d::Zero();  // extents along its own axes
  double yaw_rad = 0;                              // of its first axis
};

// Do they come closer than `gap_m`? Separating axes, exact for gap 0.
[[nodiscard]] bool Overlap(const Footprint& a, const Footprint& b, double gap_m);

// One way in which a mesh stays where it is put: turned by R, its lowest point on z = 0 and the
// middle of its footprint at the origin.
struct RestingPose {
  Pose T_table_object;
  Eigen::Vector2d half = Eigen::Vector2d::Zero();  // of the footprint
  double height = 0;
};

// A cuboid-like mesh (half turns about all three axes map it onto itself) may rest on any side that
// is broad enough for its height; any other only upright, as it was modelled. Never empty.
[[nodiscard]] std::vector<RestingPose> RestingPoses(const Mesh& mesh);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_PLACEMENT_H_
