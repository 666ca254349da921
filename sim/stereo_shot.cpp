#include "sim/stereo_shot.h"

#include <cmath>

#include "sim/edge_truth.h"
#include "sim/random.h"

namespace wirepose::sim {

StereoCalibration DefaultCalibration() {
  StereoCalibration c;
  c.width = 640;
  c.height = 480;
  c.left = {525.3, 525.9, 318.4, 242.1, -0.083, 0.021, 0.0004, -0.0003, 0};
  c.right = {527.0, 527.4, 322.6, 239.2, -0.080, 0.018, -0.0002, 0.0005, 0};
  const Vector3d tilt(0.003, -0.004, 0.002);  // rad
  c.T_right_left.R = Eigen::AngleAxisd(tilt.norm(), tilt.normalized()).toRotationMatrix();
  c.T_right_left.t = Vector3d(-0.1201, 0.0006, -0.0004);
  return c;
}

Camera LeftCamera(const StereoRig& rig) {
  const StereoCalibration& c = rig.calibration;
  return {c.left,         c.width,        c.height,     rig.T_world_left, rig.psf_sigma_px,
          rig.vignetting, rig.exposure_s, rig.velocity, rig.rotation_rate};
}

Camera RightCamera(const StereoRig& rig) {
  const StereoCalibration& c = rig.calibration;
  const Pose T_world_right = rig.T_world_left * c.T_right_left.Inverse();
  const Vector3d velocity = rig.velocity + rig.rotation_rate.cross(T_world_right.t - rig.T_world_left.t);
  return {c.right,        c.width,        c.height, T_world_right,    rig.right_psf_sigma_px,
          rig.vignetting, rig.exposure_s, velocity, rig.rotation_rate};
}

StereoShot ShootStereo(const Renderer& renderer, const StereoRig& rig, const RenderOptions& options) {
  return ShootStereo(renderer, rig, rig, options);
}

StereoShot ShootStereo(const Renderer& renderer, const StereoRig& left_rig, const StereoRig& right_rig,
                       const RenderOptions& options) {
  RenderOptions left = options, right = options;
  left.seed = Mix(options.seed, 1);
  right.seed = Mix(options.seed, 2);
  const Camera left_camera = LeftCamera(left_rig);
  const RadianceImage left_light = renderer.Render(left_camera, left);
  const Camera right_camera = RightCamera(right_rig);
  const RadianceImage right_light = renderer.Render(right_camera, right);
  // The target is a grey level, the exposure acts before the gamma curve.
  const float target = std::pow(left_rig.exposure_target, left_rig.left_sensor.gamma);
  const float exposure = left_rig.light * AutoExposure(left_light, target);
  StereoShot shot;
  shot.left = Expose(left_light, exposure, left_rig.left_sensor, Mix(options.seed, 3));
  shot.right = Expose(right_light, exposure, right_rig.right_sensor, Mix(options.seed, 4));
  shot.truth = FindTruth(renderer, left_camera, options.threads);
  for (ObjectTruth& object : shot.truth.objects) {
    object.left_edges = VisibleEdgeParts(renderer, left_camera, object.instance);
    object.right_edges = VisibleEdgeParts(renderer, right_camera, object.instance);
  }
  return shot;
}

dataset::FrameRecord ToRecord(int im_id, const StereoRig& rig, const Truth& truth) {
  dataset::FrameRecord record;
  record.im_id = im_id;
  record.T_left_world = rig.T_world_left.Inverse();
  for (const ObjectTruth& object : truth.objects) {
    record.instances.push_back({object.obj_id, object.T_camera_object, object.px_count_all, object.px_count_in_image,
                                object.px_count_visib, object.visib_fract, object.bbox_visib, object.left_edges,
                                object.right_edges});
  }
  return record;
}

dataset::DepthImage ToDepthImage(const Truth& truth) {
  dataset::DepthImage image{truth.width, truth.height, {}};
  image.pixels.reserve(truth.depth_m.size());
  for (const float depth : truth.depth_m) {
    const double level = std::round(1000.0 * double{depth} / dataset::kDepthScale);
    image.pixels.push_back(level <= 65535 ? static_cast<std::uint16_t>(level) : std::uint16_t{0});
  }
  return image;
}

}  // namespace wirepose::sim
