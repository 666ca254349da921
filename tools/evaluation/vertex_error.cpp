#include "tools/evaluation/vertex_error.h"

#include <algorithm>

namespace wirepose::evaluation {

double RelativeVertexError(const PreparedModel& model, const Pose& found, const Pose& truth) {
  double best = 9;
  for (const Pose& symmetry : model.symmetries) {
    const Pose T = truth * symmetry;
    double worst = 0;
    for (std::size_t v = 0; v < model.view.vertices.size(); ++v) {
      const Vector3d p = model.view.VertexPosition(v).cast<double>();
      worst = std::max(worst, (found * p - T * p).norm());
    }
    best = std::min(best, worst / static_cast<double>(model.view.diameter_m));
  }
  return best;
}

}  // namespace wirepose::evaluation
