// Stage 0: the raw pair becomes a rectified pair, in which equal rows see equal planes of the scene.
#ifndef WIREPOSE_STAGES_RECTIFICATION_H_
#define WIREPOSE_STAGES_RECTIFICATION_H_

#include <array>
#include <cstdint>

#include "base/image_view.h"
#include "capacities.h"
#include "geometry/camera.h"

namespace wirepose {

// Where each rectified pixel lies in the raw image. Kept at every kNodeStep-th pixel and interpolated linearly: within
// 8 pixels a usual lens bends less than 0.01 px.
struct RectificationMap {
  static constexpr int kNodeStep = 8;
  static constexpr int kNodesX = kMaxImageWidth / kNodeStep + 1;
  static constexpr int kNodesY = kMaxImageHeight / kNodeStep + 1;
  struct Node {
    std::int32_t x, y;  // raw pixel, 16.16 fixed point
  };
  struct Interval {
    std::int16_t begin = 0, end = 0;  // columns [begin, end) that see the raw image
  };

  std::array<Node, std::size_t{kNodesX} * kNodesY> nodes;
  std::array<Interval, kMaxImageHeight> valid;  // one per row; empty: begin == end
};

struct Rectification {
  RectifiedCamera camera;
  Pose T_rectified_raw;  // of the left camera: a rotation
  RectificationMap left, right;
};

// Rectifies by turning both cameras by half of their relative rotation and then the baseline into the x axis
// (Bouguet's method, as OpenCV's stereoRectify); one focal length, the mean of the four, and one principal point, such
// that the raw image centres stay as central as possible. False when a focal length or the baseline is not positive,
// R is no rotation, the right camera is not to the right of the left one, or the optical axes are more than 60 degrees
// apart.
[[nodiscard]] bool ComputeRectification(const StereoCalibration& calibration, Rectification& out);

// Virtual baseline of a camera with depth [m]: with the usual focal lengths f * baseline is that of a stereo rig, and
// so is the meaning of every threshold in pixels of disparity.
inline constexpr double kVirtualBaselineM = 0.1;

// The same for one camera with registered depth: the lens distortion is removed, the camera keeps its orientation
// (T_rectified_raw is the identity). An image without distortion and with equal focal lengths stays as it is. The right
// map sees nothing. False when a focal length is not positive.
[[nodiscard]] bool ComputeUndistortion(const DepthCalibration& calibration, Rectification& out);

// Resamples `raw` bilinearly into `out`; both of the calibrated size. Pixels outside the row's valid interval repeat
// its nearest valid pixel. Integer arithmetic only. O(pixels).
void RectifyImage(ImageView raw, const RectificationMap& map, MutableImageView out);

// Takes the nearest raw pixel of each rectified one: for depth, whose values must not be mixed across an edge. `out`
// has stride kMaxImageWidth; pixels outside the row's valid interval get 0. O(pixels).
void RectifyDepth(BasicImageView<const std::uint16_t> raw, const RectificationMap& map, int width, int height,
                  std::uint16_t* out);

// Brown-Conrady: normalised image point to raw pixel. Public for tests.
Eigen::Vector2d DistortAndProject(const CameraIntrinsics& camera, double x, double y);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_RECTIFICATION_H_
