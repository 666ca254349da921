// The stereo camera: both eyes and the truth of one moment.
#ifndef WIREPOSE_SIM_STEREO_SHOT_H_
#define WIREPOSE_SIM_STEREO_SHOT_H_

#include "geometry/camera.h"
#include "hal/dataset/dataset_writer.h"
#include "hal/dataset/png_image.h"
#include "sim/renderer.h"
#include "sim/sensor.h"
#include "sim/truth.h"

namespace wirepose::sim {

struct StereoRig {
  StereoCalibration calibration;
  Pose T_world_left;          // raw left camera in the world
  double psf_sigma_px = 0.5;  // blur of the left lens
  double right_psf_sigma_px = 0.5;
  double vignetting = 0;  // of both lenses, see Camera

  // Motion of the left camera during the exposure, in the world.
  double exposure_s = 0;
  Vector3d velocity = Vector3d::Zero();       // m/s
  Vector3d rotation_rate = Vector3d::Zero();  // rad/s

  Sensor left_sensor;
  Sensor right_sensor{.gain = 0.9F, .serial = 2};  // the eyes of real rigs differ
  float light = 1;                                 // more or less light than the exposure was chosen for
  float exposure_target = 0.8F;  // grey level over 255; both eyes are exposed as the left one asks, see AutoExposure
};

struct StereoShot {
  dataset::GrayImage left, right;  // raw, distorted
  Truth truth;                     // of the left camera
};

// A rig with everything a real one has: 640x480, f 525 px, 0.12 m baseline, barrel distortion, eyes
// not quite alike and not quite parallel.
[[nodiscard]] StereoCalibration DefaultCalibration();

// Renders both eyes. Deterministic: the same arguments give the same bytes, whatever
// `options.threads` is.
[[nodiscard]] StereoShot ShootStereo(const Renderer& renderer, const StereoRig& rig, const RenderOptions& options);

// As above with eyes that are not where one rig has them: the left eye of the first, the right one
// of the second.
[[nodiscard]] StereoShot ShootStereo(const Renderer& renderer, const StereoRig& left_rig, const StereoRig& right_rig,
                                     const RenderOptions& options);

// One eye of the rig as a camera.
[[nodiscard]] Camera LeftCamera(const StereoRig& rig);
[[nodiscard]] Camera RightCamera(const StereoRig& rig);

// What a data set keeps of a shot.
[[nodiscard]] dataset::FrameRecord ToRecord(int im_id, const StereoRig& rig, const Truth& truth);
// Depth in units of dataset::kDepthScale, rounded; 0 where there is none or it is too far.
[[nodiscard]] dataset::DepthImage ToDepthImage(const Truth& truth);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_STEREO_SHOT_H_
