// Are the eyes exposed together, and as they were calibrated? What the row offsets of recent frames say.
#ifndef WIREPOSE_PIPELINE_ROW_ALIGNMENT_H_
#define WIREPOSE_PIPELINE_ROW_ALIGNMENT_H_

#include <array>
#include <cstdint>
#include <span>

#include "geometry/camera.h"
#include "stages/row_offsets.h"

namespace wirepose {

enum class RowState : std::uint8_t {
  kUnknown,  // too few frames, or too few corners in them
  kAligned,
  kSteadyOffset,   // rows are off by the same motion of an eye in all recent frames: the calibration no longer holds
  kVaryingOffset,  // rows are off by a motion that changes: eyes exposed at different times while the rig or the scene
                   // moves, or a loose eye
};

struct RowAlignment {
  RowState state = RowState::kUnknown;
  std::uint32_t corners = 0;  // of the last frame, as the next two
  float median_px = 0;        // row in the right image minus row in the left one
  float spread_px = 0;        // 1.48 times the median distance from the median
  float steady_px = 0;        // root mean square over the image, noise taken away; of the last 128 frames or so
  float varying_px = 0;       // the same of what is not steady; reached in half of the last 16 frames
};

// Row offsets are the only image of a stereo pair's relative pose that needs no known scene. Were the right eye turned
// by w and shifted by s against its calibrated place, a point at (x, y) [focal lengths, right eye] with disparity d
// would leave its row by
//
//   f (w_x (1 + y^2) - w_y x y - w_z x) - (s_y - s_z y) d / baseline      [px]
//
// which are all five numbers that an epipolar geometry has (Longuet-Higgins 1981). An eye that is exposed late by dt on
// a rig that moves with twist (v, w) is one that is turned by w dt and shifted by v dt, the same for all points that
// stand still. So each frame gives the five by robust least squares, and frames together tell what stays from what
// changes. Motion along the rows alone shows nothing.
//
// What this cannot tell: a rig that keeps one and the same motion for several seconds looks like one that is out of
// calibration, and one that was knocked like one with a time offset until the new state has lasted (100 to 300 frames).
//
// Fixed memory, no clock, not thread safe. The same offsets give the same numbers on every target.
class AlignmentMonitor {
 public:
  // A good calibration leaves 0.1 to 0.2 px. At an edge of 45 degrees 0.3 px of row offset are 0.3 px of disparity:
  // 5 mm at 1 m with f * baseline = 63 px m, as much as poses may be off altogether.
  static constexpr float kLimit_px = 0.3F;
  static constexpr float kCalm_px = 0.2F;          // an alarm ends below
  static constexpr std::size_t kMinCorners = 8;    // five unknowns, and some to contradict
  static constexpr std::uint32_t kMinFrames = 30;  // before anything is said

  // One frame's offsets. O(corners).
  void Update(const RectifiedCamera& camera, std::span<const RowOffset> offsets);
  // As of the last Update.
  [[nodiscard]] const RowAlignment& alignment() const { return alignment_; }

 private:
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  static constexpr std::size_t kRecent = 16;

  // Weighted normal equations of the eye's motion.
  struct Normal {
    Matrix5 H = Matrix5::Zero();
    Vector5 g = Vector5::Zero();
    double weight = 0;
    [[nodiscard]] Vector5 Solve() const;
    // Mean square of the offsets that the motion makes, px^2.
    [[nodiscard]] double Power(const Vector5& motion) const { return motion.dot(H * motion) / weight; }
  };

  static Vector5 Slope(const RectifiedCamera& camera, const RowOffset& offset);
  // The frame's motion by robust least squares; false when too few corners agree. `noise_power`: what the noise of the
  // corners adds to Power, px^2.
  static bool Fit(const RectifiedCamera& camera, std::span<const RowOffset> offsets, Normal& normal, Vector5& motion,
                  double& noise_power);
  void DescribeFrame(std::span<const RowOffset> offsets);
  void AddToSteady(const Normal& frame, const Vector5& motion);
  void Judge();

  RowAlignment alignment_;
  Normal steady_;                          // of recent frames together, the newest weighs most
  double noise_power_ = 0;                 // mean over the same frames
  std::array<double, kRecent> varying_{};  // power of the last frames, a ring
  std::uint32_t frames_ = 0;               // that could be used; stops counting at its largest number
  std::uint32_t frames_without_ = 0;       // that could not, since the last that could
};

}  // namespace wirepose

#endif  // WIREPOSE_PIPELINE_ROW_ALIGNMENT_H_
