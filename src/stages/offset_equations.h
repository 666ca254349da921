// Normal equations of the adjustment: offsets of image edges from model edges, weighed by how their errors hang
// together.
#ifndef WIREPOSE_STAGES_OFFSET_EQUATIONS_H_
#define WIREPOSE_STAGES_OFFSET_EQUATIONS_H_

#include <cstdint>

#include "base/fixed_vector.h"
#include "geometry/se3.h"
#include "stages/sample_edges.h"

namespace wirepose {

// Standard deviations, px.
struct OffsetErrors {
  float noise_px = 0.4F;  // of every sample on its own
  float edge_px = 0.6F;   // common to all samples of an edge: it may lie on a shadow or on the next line of print
  float image_px = 0.2F;  // common to all samples of an image: its calibration, its blur
  // For the covariance alone, since poses that fit badly are less certain: times the residuals' weighted mean square is
  // added to noise_px^2, times that of the edges' mean residuals to edge_px^2.
  float scatter_gain = 4;
};

// One found offset with its derivative by the twist.
struct OffsetRow {
  Eigen::Matrix<double, 1, 6> J;  // px by rad and m: PerturbLeft about the model origin
  double residual = 0;            // px, image edge minus model edge along the normal
  double weight = 0;
  std::uint16_t edge = 0;
  std::uint8_t image = 0;            // 0: left
  Vector2 normal = Vector2::Zero();  // float: a thousand rows lie on the stack
};

// The rows of an edge follow each other.
using OffsetRows = FixedVector<OffsetRow, 2 * kMaxEdgeSamples>;

// Generalised least squares under the model of OffsetErrors: the offset b_e that an edge's samples share in both
// images, and the shift s of the right image against the left one, are unknowns of known variance, eliminated by Schur
// complements. For the twist x
//   sum w (r - J x - b_e - [right] n . s)^2 / noise_px^2 + sum b_e^2 / edge_px^2 + |s|^2 / (2 image_px^2)
// is least. So an edge that was taken for another one moves the pose little, and depth comes from the parallax, which
// such an edge does not touch, rather than from the size. Shifts far above image_px count as errors of the calibration
// or of the object's size, which have no limit: their variance grows with them (Geman-McClure). Source: mixed models,
// Laird & Ware 1982. No heap.
class OffsetEquations {
 public:
  explicit OffsetEquations(const OffsetErrors& errors) : errors_(errors) {}

  // Of the weighted rows, in px^2: the normal matrix of the twist [rad, m] (its lower triangle; the rest stays as it
  // is) and the right side. No rows give zeros. O(rows).
  void Sum(const OffsetRows& rows, Matrix6d& H, Vector6d& g);
  // Takes over what the equations of the last Sum say about the shift when the twist solves them.
  void UpdateShift(const Vector6d& twist);
  // Covariance of the right side of the last Sum (the middle of the sandwich).
  [[nodiscard]] Matrix6d Spread(const OffsetRows& rows) const;
  // The variance for which a sample has weight 1, px^2.
  [[nodiscard]] double UnitVariance() const;
  // Of the right image against the left one, px.
  [[nodiscard]] const Eigen::Vector2d& shift() const { return shift_; }

 private:
  // Derivatives by the twist and by the shift.
  using Vector8d = Eigen::Matrix<double, 8, 1>;
  using Matrix8d = Eigen::Matrix<double, 8, 8>;
  static Vector8d Derivative(const OffsetRow& row);
  [[nodiscard]] Vector8d SharedDerivative(const OffsetRow* begin, const OffsetRow* end) const;
  [[nodiscard]] double ShiftInformation() const;

  OffsetErrors errors_;
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d free_shift_ = Eigen::Vector2d::Zero();  // the shift when the pose stays as it is ...
  Eigen::Matrix<double, 2, 6> gain_ = Eigen::Matrix<double, 2, 6>::Zero();  // ... less this by the twist
};

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_OFFSET_EQUATIONS_H_
