// How the readers of a data set end at an error. Used inside this room only.
#ifndef WIREPOSE_HAL_DATASET_MALFORMED_H_
#define WIREPOSE_HAL_DATASET_MALFORMED_H_

#include <string>

namespace wirepose::dataset {

// Leaves a reader at the first thing that is wrong; caught where the file or the data set is read.
struct Malformed {
  std::string message;  // one line: file, place, remedy
};

}  // namespace wirepose::dataset

#endif  // WIREPOSE_HAL_DATASET_MALFORMED_H_
