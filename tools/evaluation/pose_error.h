// How wrong an estimated pose is, as bop_toolkit measures it.
#ifndef WIREPOSE_TOOLS_EVALUATION_POSE_ERROR_H_
#define WIREPOSE_TOOLS_EVALUATION_POSE_ERROR_H_

#include "tools/evaluation/ground_truth.h"

namespace wirepose::evaluation {

// Source: Hodan et al., "BOP Challenge 2020 on 6D Object Localization", section 2.2.
struct PoseError {
  double mssd_mm = 0;         // maximum symmetry-aware surface distance, over the model's vertices
  double mspd_px = 0;         // maximum symmetry-aware projection distance; infinite if no symmetry has
                              // every vertex in front
  double translation_mm = 0;  // to the symmetric true pose that gives mssd_mm, as the two below
  double rotation_deg = 0;
  RigidMm nearest_truth;  // that pose: T_camera_model
};

// `K` is the undistorted pinhole in which mspd_px is measured. O(vertices * symmetries).
PoseError MeasurePose(const ObjectTruth& object, const Matrix3d& K, const RigidMm& estimate, const RigidMm& truth);

// The identity, the discrete symmetries and, for each axis, 63 further steps of a turn combined
// with each of them.
struct ContinuousSymmetry {
  Vector3d axis = Vector3d::UnitZ();
  Vector3d offset_mm = Vector3d::Zero();
};
std::vector<RigidMm> EnumerateSymmetries(const std::vector<RigidMm>& discrete,
                                         const std::vector<ContinuousSymmetry>& continuous);

// Normalised estimation error squared: (twist from the estimate to the truth)^T covariance^-1
// (twist), the covariance as in Detection::covariance (rotation rad, translation m, camera frame,
// about the model origin). Chi-square distributed with 6 degrees of freedom when the covariance is
// right. Negative if the covariance is not positive.
double NormalizedErrorSquared(const RigidMm& estimate, const RigidMm& truth, const Matrix6d& covariance);

// Share of a chi-square distribution with 6 degrees of freedom that lies below `x`.
double ChiSquare6Cdf(double x);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_POSE_ERROR_H_
