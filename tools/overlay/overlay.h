// What the recognizer saw, drawn on what the camera saw.
#ifndef WIREPOSE_TOOLS_OVERLAY_OVERLAY_H_
#define WIREPOSE_TOOLS_OVERLAY_OVERLAY_H_

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/image_view.h"
#include "geometry/camera.h"
#include "geometry/line3.h"
#include "geometry/segment2.h"
#include "model/model_view.h"

namespace wirepose::overlay {

enum class PoseKind { kFound, kTruth };

// One model drawn at one pose: edges in front solid, hidden ones dashed; found ones coloured by
// `kind`.
struct OverlayObject {
  ModelView model;
  Pose T_rectified_model;  // rectified left camera; m
  PoseKind kind = PoseKind::kFound;
  std::string label;  // for example name and score; empty: none
};

// A 3D line that belongs to a corresponding line set. A line may belong to several; the last one
// colours it.
struct LineSetMember {
  std::uint32_t set = 0;  // any numbering; equal numbers, equal colour
  std::size_t line = 0;   // index into OverlayInput::lines
};

// Everything is of one frame and in the rectified left image. All views and spans must live as long
// as the call.
struct OverlayInput {
  ImageView left_rectified;
  RectifiedCamera camera;
  std::span<const Segment2> segments;
  std::span<const Line3> lines;
  std::vector<LineSetMember> line_sets;
  std::vector<OverlayObject> objects;
  std::string caption;  // bottom line, for example scene and image
};

// Two panels side by side, each enlarged twice, BGR. Left: segments without depth grey, 3D lines
// coloured by depth, with a scale. Right: the corresponding line sets, each in a colour, and the
// models.
cv::Mat DrawOverlay(const OverlayInput& input);

}  // namespace wirepose::overlay

#endif  // WIREPOSE_TOOLS_OVERLAY_OVERLAY_H_
