// Stage 6: do image edges go on where the model's edges end?
#ifndef WIREPOSE_STAGES_OVERRUN_H_
#define WIREPOSE_STAGES_OVERRUN_H_

#include "geometry/camera.h"
#include "model/prepared_model.h"
#include "stages/edge_map.h"

namespace wirepose {

// Shares, 0..1; few edges count as four, so that little evidence says little.
struct Overrun {
  float share = 0;    // of the ends of long visible edges: beyond them the left image shows an edge of that direction
  float crossed = 0;  // of long visible edges: such edges cross them at both ends, as where a face goes on
};

// Do image edges go on where the model's end? An object's edges end at its corners; lines of clutter that happen to lie
// right seldom do, and on a larger box all edges that run one way go on. `seen`: the edges that are visible at the
// pose. O(edges).
Overrun MeasureOverrun(const RectifiedCamera& camera, const EdgeMap& left, const PreparedModel& model,
                       const Pose& T_camera_model, const EdgeBits& seen);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_OVERRUN_H_
