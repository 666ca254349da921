// A model with the tables that matching needs, derived once when the model is added.
#ifndef WIREPOSE_MODEL_PREPARED_MODEL_H_
#define WIREPOSE_MODEL_PREPARED_MODEL_H_

#include <array>
#include <cstdint>

#include "base/fixed_vector.h"
#include "capacities.h"
#include "model/model_view.h"

namespace wirepose {

struct PreparedEdge {
  Vector3 a, b, direction;  // m, model frame; direction from a to b
  float length_m = 0;
  bool representative = true;  // the first edge of its symmetry orbit: the others repeat its hypotheses
};

// Which edges an observer at some place sees.
using EdgeBits = std::array<std::uint32_t, kMaxModelEdges / 32>;

inline bool HasEdge(const EdgeBits& bits, std::size_t edge) { return ((bits[edge / 32] >> (edge % 32)) & 1U) != 0; }

struct PreparedModel {
  ModelView view;
  Vector3 centre = Vector3::Zero();  // of the bounding box
  FixedVector<PreparedEdge, kMaxModelEdges> edges;
  // Symmetries as poses, the identity first.
  FixedVector<Pose, kMaxModelSymmetries> symmetries;
  std::array<Vector3, 8> corners;  // of the bounding box
  bool convex = false;             // no face can hide an edge of another one

  // Edges that an observer at `eye` (model frame, m) sees: from the model's table of aspects, without the edges whose
  // faces both turn away from this very place. O(aspects + edges).
  [[nodiscard]] EdgeBits VisibleEdges(const Vector3& eye) const;
  // True when a face of the edge turns towards the eye; it may still be hidden by other faces.
  [[nodiscard]] bool FacesEye(std::size_t edge, const Vector3& eye) const;
};

// Fills `out`. O(edges^2 * symmetries).
void PrepareModel(const ModelView& view, PreparedModel& out);

}  // namespace wirepose

#endif  // WIREPOSE_MODEL_PREPARED_MODEL_H_
