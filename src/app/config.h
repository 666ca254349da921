// The configuration of the robot program; config/wireposed.yaml explains every key.
#ifndef WIREPOSE_APP_CONFIG_H_
#define WIREPOSE_APP_CONFIG_H_

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/dds_config.h"
#include "hal/libcamera/libcamera_config.h"
#include "hal/replay/replay_camera.h"
#include "hal/simulated/simulated_camera.h"

namespace wirepose::app {

enum class CameraBackend : std::uint8_t { kUnset, kLibcamera, kReplay, kSimulated };

// Throws UsageError for a name that is none of libcamera, replay, simulated; `where` begins its
// message.
CameraBackend ParseCameraBackend(const std::string& name, const std::string& where);

struct CameraConfig {
  CameraBackend backend = CameraBackend::kUnset;
  // Without a frame for that long, health says no_frames.
  std::chrono::milliseconds timeout{1000};
  hal::LibcameraConfig libcamera;
  hal::ReplayConfig replay;
  hal::SimulatedConfig simulated;
};

struct Config {
  std::filesystem::path file;  // for messages
  CameraConfig camera;
  DdsConfig dds;
  bool tracking = true;                       // objects are followed over frames
  std::vector<std::filesystem::path> models;  // .wpm files and folders of them
  std::vector<std::uint32_t> search_for;      // model ids; empty: all that were loaded
};

// Reads and checks the whole file. Throws UsageError: "file:line: key: reason and remedy".
Config LoadConfig(const std::filesystem::path& file);

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_CONFIG_H_
