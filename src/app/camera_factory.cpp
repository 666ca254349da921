#include "app/camera_factory.h"

#include "app/failure.h"

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

std::unique_ptr<hal::StereoCamera> CreateSimulated(const Config& config) {
#ifdef WIREPOSE_SIMULATED_CAMERA
  if (config.camera.simulated.mesh_dir.empty()) {
    RefuseMissing(config, "camera.simulated.meshes", "name the folder of the objects' meshes");
  }
  return std::make_unique<hal::SimulatedCamera>(config.camera.simulated);
#else
  throw UsageError(config.file.string() + ": camera.backend: this build has no simulated backend; " +
                   "choose another camera or build with WIREPOSE_HOST=ON");
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
      throw UsageError(config.file.string() + ": camera.backend: this build has no libcamera " +
                       "backend; choose replay or simulated");
    case CameraBackend::kUnset:
      break;
  }
  RefuseMissing(config, "camera.backend", "choose libcamera, replay or simulated, also as --camera");
}

}  // namespace wirepose::app
