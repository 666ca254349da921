// Distance of two poses of one model, for logs: the metrics proper are in pose_error.h.
#ifndef WIREPOSE_TOOLS_EVALUATION_VERTEX_ERROR_H_
#define WIREPOSE_TOOLS_EVALUATION_VERTEX_ERROR_H_

#include "model/prepared_model.h"

namespace wirepose::evaluation {

// Largest vertex distance, for the model symmetry that makes it smallest (MSSD), in diameters; at most 9.
double RelativeVertexError(const PreparedModel& model, const Pose& found, const Pose& truth);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_VERTEX_ERROR_H_
