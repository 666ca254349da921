// Things that stand about in kitchens, as meshes. All are centred at the origin, axis z up.
#ifndef WIREPOSE_SIM_SHAPES_H_
#define WIREPOSE_SIM_SHAPES_H_

#include <vector>

#include "sim/mesh.h"

namespace wirepose::sim {

// Radius and height of a profile that is turned about z, from bottom to top.
struct ProfilePoint {
  float radius = 0, z = 0;  // m
};
// The profile's ends close themselves; z is shifted so that the middle is at 0.
[[nodiscard]] Mesh MakeLathe(const std::vector<ProfilePoint>& profile, int sides = 64);

[[nodiscard]] Mesh MakeBottle(float radius, float height);
[[nodiscard]] Mesh MakeMug(float radius, float height);
[[nodiscard]] Mesh MakePlates(float radius, int count);
[[nodiscard]] Mesh MakeBowl(float radius, float height);
// A carton with a gable on top, as milk comes in.
[[nodiscard]] Mesh MakeGableCarton(const Vector3& size);
// A box with a slanted top and handles of knives that stick out of it.
[[nodiscard]] Mesh MakeKnifeBlock(const Vector3& size);

// Puts `part`, moved by `at`, into `mesh`.
void Append(Mesh& mesh, const Mesh& part, const Vector3& at = Vector3::Zero());

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SHAPES_H_
