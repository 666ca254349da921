// Poses that look alike: by the model's exact symmetries, and by turns that nearly are symmetries.
#ifndef WIREPOSE_MODEL_SYMMETRY_H_
#define WIREPOSE_MODEL_SYMMETRY_H_

#include <cstddef>
#include <cstdint>

#include "model/prepared_model.h"

namespace wirepose {

// Index into model.symmetries of the S for which T * S is turned least against `R_reference`; of equals the first.
// O(symmetries).
[[nodiscard]] std::size_t NearestSymmetry(const PreparedModel& model, const Matrix3d& R, const Matrix3d& R_reference);

// The edge that the symmetry carries onto `edge`; `edge` itself where none is. O(edges).
[[nodiscard]] std::size_t EdgeBeforeSymmetry(const PreparedModel& model, const Pose& symmetry, std::size_t edge);

// What NearestSymmetry compares with when nothing is known of earlier frames. No rule without memory is free of seams
// (SO(3) over a symmetry group has no continuous section), but where they lie can be chosen: an object that stands
// upright and is seen from somewhat above stays upright, and its seams in yaw avoid views along its axes and diagonals.
[[nodiscard]] Matrix3d CanonicalOrientation();

// Rotation k of 24: the proper rotations that map the coordinate axes onto themselves; 0 is the identity.
inline constexpr std::size_t kBoxTurns = 24;
[[nodiscard]] Matrix3d BoxTurn(std::size_t k);

// The turn as a rigid motion of the model about the centre of its bounding box.
[[nodiscard]] Pose TurnedModel(const PreparedModel& model, std::size_t k);

// Turns, as arguments of BoxTurn.
using NearTurns = FixedVector<std::uint8_t, kMaxNearTurns>;

// Turns about the box centre that are no symmetry but leave the box nearly as it is and carry
// much of the wireframe onto itself, so that a view which shows little of the rest fits both poses. Turns that a
// symmetry carries onto each other appear once; those that keep most of the wireframe come first. O(edges^2).
[[nodiscard]] NearTurns FindNearTurns(const PreparedModel& model);

}  // namespace wirepose

#endif  // WIREPOSE_MODEL_SYMMETRY_H_
