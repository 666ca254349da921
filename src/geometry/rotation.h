// Is a matrix from a file a rotation?
#ifndef WIREPOSE_GEOMETRY_ROTATION_H_
#define WIREPOSE_GEOMETRY_ROTATION_H_

#include <Eigen/LU>

#include "geometry/se3.h"

namespace wirepose {

// True when no element of R R^T is further than 1e-3 from the identity's (hand-typed matrices have four decimals) and R
// does not mirror. False for NaN.
inline bool IsRotation(const Matrix3d& R) {
  const double error = (R * R.transpose() - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  return error < 1e-3 && R.determinant() > 0;
}

}  // namespace wirepose

#endif  // WIREPOSE_GEOMETRY_ROTATION_H_
