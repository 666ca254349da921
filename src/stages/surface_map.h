// The surface that a model shows at a pose: which cells of the image it covers, at which disparity.
#ifndef WIREPOSE_STAGES_SURFACE_MAP_H_
#define WIREPOSE_STAGES_SURFACE_MAP_H_

#include <array>

#include "geometry/camera.h"
#include "model/prepared_model.h"

namespace wirepose {

// A depth buffer at a quarter of the image's resolution. Cell (i, j) stands for pixel (4 i, 4 j).
struct SurfaceMap {
  static constexpr int kScale = 4;
  static constexpr int kWidth = kMaxImageWidth / kScale, kHeight = kMaxImageHeight / kScale;

  int width = 0, height = 0;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // cells [x0, x1) x [y0, y1) hold the object and two cells around it
  std::array<float, std::size_t{kWidth} * kHeight> disparity;  // px of the full image; 0: not the object

  [[nodiscard]] float At(int i, int j) const { return disparity[static_cast<std::size_t>(j * kWidth + i)]; }

  // Of the cell nearest to a pixel; 0 outside of the box.
  [[nodiscard]] float AtPixel(int x, int y) const {
    const int i = (x + kScale / 2) / kScale, j = (y + kScale / 2) / kScale;
    return x >= 0 && y >= 0 && i >= x0 && j >= y0 && i < x1 && j < y1 ? At(i, j) : 0;
  }
};

// Draws the faces that turn towards the camera; the nearest one wins. Faces that come closer than 5 cm are left out.
// O(cells of the bounding box + triangles * their cells).
void RenderSurface(const RectifiedCamera& camera, const PreparedModel& model, const Pose& T_camera_model,
                   SurfaceMap& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_SURFACE_MAP_H_
