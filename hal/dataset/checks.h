// What the readers of a data set have in common. Used inside this room only.
#ifndef WIREPOSE_HAL_DATASET_CHECKS_H_
#define WIREPOSE_HAL_DATASET_CHECKS_H_

#include <Eigen/LU>
#include <string>

#include "geometry/se3.h"

namespace wirepose::dataset {

// Leaves a reader at the first thing that is wrong; caught where the file or the data set is read.
struct Malformed {
  std::string message;
};

inline bool IsRotation(const Matrix3d& R) {
  constexpr double kTolerance = 1e-3;  // hand-typed matrices have four decimals
  const double deviation = (R * R.transpose() - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  return deviation < kTolerance && R.determinant() > 0;
}

}  // namespace wirepose::dataset

#endif  // WIREPOSE_HAL_DATASET_CHECKS_H_
