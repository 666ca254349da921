// A model with the tables that matching needs, derived once when the model is added.
#ifndef WIREPOSE_MODEL_PREPARED_MODEL_H_
#define WIREPOSE_MODEL_PREPARED_MODEL_H_

#include <array>
#include <bit>
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

// The first edge from `edge` on that is set; kMaxModelEdges when none is.
inline std::size_t NextEdge(const EdgeBits& bits, std::size_t edge) {
  for (std::size_t word = edge / 32, skip = edge % 32; word < bits.size(); ++word, skip = 0) {
    const std::uint32_t rest = bits[word] >> skip;
    if (rest != 0) return word * 32 + skip + static_cast<std::size_t>(std::countr_zero(rest));
  }
  return kMaxModelEdges;
}

// One member of a model line set, as matching reads it: the length of the other edge stands with the edge.
struct PreparedMember {
  float distance_m = 0, angle_rad = 0, farthest_end_m = 0;
  std::uint16_t other_edge = 0;
  std::uint8_t base_end = 2;  // of the base edge at which the other one meets it: 0 a, 1 b; 2: none
};

// A line set with a representative base edge; members [first, corner_end) share a corner with the base edge, and each
// part comes by rising distance.
struct PreparedSet {
  LineSetKind kind = LineSetKind::kParallel;
  std::uint16_t base_edge = 0;
  std::uint16_t first = 0, corner_end = 0, end = 0;
  float max_distance_m = 0, max_farthest_end_m = 0;  // of all members
};

// A face that all of the object lies behind: it can stand on it.
struct PreparedFoot {
  std::uint16_t face = 0;
  Vector3 centre = Vector3::Zero();  // mean of its triangles' corners, m, model frame
};

struct PreparedModel {
  ModelView view;
  Vector3 centre = Vector3::Zero();  // of the bounding box
  float max_centre_shift_m = 0;      // the farthest that a symmetry carries it
  FixedVector<PreparedEdge, kMaxModelEdges> edges;
  // Symmetries as poses, the identity first.
  FixedVector<Pose, kMaxModelSymmetries> symmetries;
  FixedVector<PreparedSet, kMaxModelLineSets> sets;
  FixedVector<PreparedMember, kMaxModelSetMembers> members;
  std::array<Vector3, 8> corners;                 // of the bounding box
  FixedVector<PreparedFoot, kMaxModelFeet> feet;  // by falling area
  bool convex = false;                            // no face can hide an edge of another one
  // Nearest aspect of a direction, by cube face and cell.
  static constexpr int kCells = 12;
  std::array<std::uint8_t, 6 * kCells * kCells> nearest_aspect{};

  // Edges that an observer at `eye` (model frame, m) sees: from the model's table of aspects, without the edges whose
  // faces both turn away from this very place. O(edges).
  [[nodiscard]] EdgeBits VisibleEdges(const Vector3& eye) const;
  // The same without the second test: what the table says for this direction. O(1).
  [[nodiscard]] const EdgeBits& EdgesSeenFrom(const Vector3& eye) const;
  // True when a face of the edge turns towards the eye; it may still be hidden by other faces.
  [[nodiscard]] bool FacesEye(std::size_t edge, const Vector3& eye) const;
};

// Fills `out`. O(edges^2 * symmetries + cells * aspects).
void PrepareModel(const ModelView& view, PreparedModel& out);

}  // namespace wirepose

#endif  // WIREPOSE_MODEL_PREPARED_MODEL_H_
