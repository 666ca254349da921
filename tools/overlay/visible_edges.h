// Which parts of a model's edges a camera sees.
#ifndef WIREPOSE_TOOLS_OVERLAY_VISIBLE_EDGES_H_
#define WIREPOSE_TOOLS_OVERLAY_VISIBLE_EDGES_H_

#include <vector>

#include "model/model_view.h"

namespace wirepose::overlay {

// A part of one edge, end points in the camera frame, m.
struct EdgePiece {
  std::uint16_t edge = 0;
  bool hidden = false;  // behind the model's own surface
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
};

// Cuts every edge where its visibility changes, to 1/32 of its length, by rays from the camera
// centre against every triangle. Parts nearer than 10 mm to the camera's plane are left out, so
// that the pieces can be projected. Brute force on purpose: it shares nothing with the recognizer's
// own visibility. O(edges * triangles).
std::vector<EdgePiece> CutEdges(const ModelView& model, const Pose& T_camera_model);

}  // namespace wirepose::overlay

#endif  // WIREPOSE_TOOLS_OVERLAY_VISIBLE_EDGES_H_
