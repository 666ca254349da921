// The only file of the robot program that knows the camera backends.
#ifndef WIREPOSE_APP_CAMERA_FACTORY_H_
#define WIREPOSE_APP_CAMERA_FACTORY_H_

#include <memory>

#include "app/config.h"
#include "hal/stereo_camera.h"

namespace wirepose::app {

// The camera that the configuration names, closed. Throws UsageError when this build does not have
// it or a key that it needs is missing.
std::unique_ptr<hal::StereoCamera> CreateCamera(const Config& config);

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_CAMERA_FACTORY_H_
