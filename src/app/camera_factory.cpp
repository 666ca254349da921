#include "app/camera_factory.h"

#include "app/failure.h"
#ifdef WIREPOSE_LIBCAMERA
#include "hal/libcamera/libcamera_camera.h"
#endif

namespace wirepose::app {
namespace {

[[noreturn]] void RefuseMissing(const Config& config, const char* key, const char* remedy) {
  throw UsageError(config.file.string() + ": " + key + ": missing; " + remedy);
}

std::unique_ptr<hal::StereoCamera> CreateReplay(const Config& config) {
  if (config.camera.replay.root.empty()) {
    RefuseMissing(config, "camera.replay.data_set", "name the folder of a data set");
  }
  return std::make_unique<hal::ReplayCamera>(config.camera.replay);
}

std::unique_ptr<hal::StereoCamera> CreateLibcamera(const Config& config) {
#ifdef WIREPOSE_LIBCAMERA
  const hal::LibcameraConfig& camera = config.camera.libcamera;
  if (camera.calibration_path.empty()) {
    RefuseMissing(config, "camera.libcamera.calibration", "name the rig's calib.yaml");
  }
  if (camera.left.empty()) RefuseMissing(config, "camera.libcamera.left", "name the left camera");
  if (camera.right.empty() && !camera.side_by_side) {
    RefuseMissing(config, "camera.libcamera.right", "name the right camera, or set side_by_side");
  }
  return std::make_unique<hal::LibcameraCamera>(camera);
#else
  throw UsageError(config.file.string() + ": camera.backend: this build has no libcamera backend; choose another " +
                   "camera or install libcamera-dev and build again");
#endif
}

std::unique_ptr<hal::StereoCamera> CreateSimulated(const Config& config) {
#ifdef WIREPOSE_SIMULATED_CAMERA
  if (config.camera.simulated.mesh_dir.empty()) {
    RefuseMissing(config, "camera.simulated.meshes", "name the folder of the objects' meshes");
  }
  return std::make_unique<hal::SimulatedCamera>(config.camera.simulated);
#else
  throw UsageError(config.file.string() + ": camera.backend: this build has no simulated backend; " +
                   "choose another camera or build with WIREPOSE_SIMULATOR=ON");
#endif
}

}  // namespace

std::unique_ptr<hal::StereoCamera> CreateCamera(const Config& config) {
  switch (config.camera.backend) {
    case CameraBackend::kReplay:
      return CreateReplay(config);
    case CameraBackend::kSimulated:
      return CreateSimulated(config);
    case CameraBackend::kLibcamera:
      return CreateLibcamera(config);
    case CameraBackend::kUnset:
      break;
  }
  RefuseMissing(config, "camera.backend", "choose libcamera, replay or simulated, also as --camera");
}

}  // namespace wirepose::app
