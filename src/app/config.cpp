#include "app/config.h"

#include <limits>

#include "app/failure.h"
#include "yaml/yaml_section.h"

namespace wirepose::app {
namespace {

using yaml::YamlSection;

constexpr std::int64_t kMaxFrames = 1'000'000'000;

hal::LibcameraConfig ReadLibcamera(YamlSection section) {
  hal::LibcameraConfig config;
  std::int64_t exposure_us = 0, skew_us = config.max_skew.count();
  double gain = 0;
  section.Read("calibration", config.calibration_path);
  section.Read("left", config.left);
  section.Read("right", config.right);
  section.Read("side_by_side", config.side_by_side);
  section.Read("pixel_format", config.stream.pixel_format);
  section.Read("frame_rate_hz", config.stream.frame_rate_hz, 0, 1000);
  section.Read("exposure_us", exposure_us, 0, 1'000'000);
  section.Read("gain", gain, 0, 1000);
  section.Read("max_skew_us", skew_us, 0, 1'000'000);
  section.Finish();
  config.stream.exposure_us = static_cast<std::int32_t>(exposure_us);
  config.stream.gain = static_cast<float>(gain);
  config.max_skew = std::chrono::microseconds(skew_us);
  return config;
}

hal::ReplayConfig ReadReplay(YamlSection section) {
  hal::ReplayConfig config;
  std::int64_t scene = 0;
  section.Read("data_set", config.root);
  section.Read("split", config.split);
  if (section.Read("scene", scene, 0, 999'999)) config.scene_id = static_cast<int>(scene);
  section.Read("loop", config.loop);
  section.Read("preload", config.preload);
  section.Read("frame_rate_hz", config.frame_rate_hz, 0, 1000);
  section.Finish();
  return config;
}

hal::SimulatedConfig ReadSimulated(YamlSection section) {
  hal::SimulatedConfig config;
  std::int64_t seed = 0, scene = 0, samples = 0;
  std::int64_t frames = static_cast<std::int64_t>(config.frame_count), loop_frames = 0;
  double rate_hz = 0;
  section.Read("meshes", config.mesh_dir);
  section.Read("scenario", config.scenario_path);
  section.Read("cache", config.cache_path);
  section.Read("calibration", config.calibration_path);
  if (section.Read("seed", seed, 0, std::numeric_limits<std::int64_t>::max())) {
    config.seed = static_cast<std::uint64_t>(seed);
  }
  section.Read("scene", scene, 0, 1'000'000);
  section.Read("frames", frames, 0, kMaxFrames);
  section.Read("loop_frames", loop_frames, 0, 1000);
  config.loop_frames = static_cast<std::uint64_t>(loop_frames);
  if (section.Read("frame_rate_hz", rate_hz, 1, 1000)) config.frame_rate_hz = rate_hz;
  if (section.Read("samples_per_pixel", samples, 4, 36)) config.samples_per_pixel = static_cast<int>(samples);
  section.Read("truth_file", config.truth_path);
  section.Finish();
  config.scene = static_cast<int>(scene);
  config.frame_count = static_cast<std::uint64_t>(frames);
  return config;
}

CameraConfig ReadCamera(YamlSection section, const std::filesystem::path& file) {
  CameraConfig config;
  std::string backend;
  std::int64_t timeout_ms = config.timeout.count();
  if (section.Read("backend", backend)) {
    config.backend = ParseCameraBackend(backend, file.string() + ": camera.backend");
  }
  section.Read("timeout_ms", timeout_ms, 10, 60'000);
  config.timeout = std::chrono::milliseconds(timeout_ms);
  config.libcamera = ReadLibcamera(section.Section("libcamera"));
  config.replay = ReadReplay(section.Section("replay"));
  config.simulated = ReadSimulated(section.Section("simulated"));
  section.Finish();
  return config;
}

void ReadRecognizer(YamlSection section, Config& config) {
  section.Read("tracking", config.tracking);
  section.Finish();
}

}  // namespace

CameraBackend ParseCameraBackend(const std::string& name, const std::string& where) {
  if (name == "libcamera") return CameraBackend::kLibcamera;
  if (name == "replay") return CameraBackend::kReplay;
  if (name == "simulated") return CameraBackend::kSimulated;
  throw UsageError(where + ": no camera '" + name + "'; choose libcamera, replay or simulated");
}

Config LoadConfig(const std::filesystem::path& file) {
  try {
    YamlSection section(file);
    Config config;
    config.file = file;
    config.camera = ReadCamera(section.Section("camera"), file);
    config.dds = ReadDds(section.Section("dds"));
    ReadRecognizer(section.Section("recognizer"), config);
    section.Read("models", config.models);
    section.Read("search_for", config.search_for);
    section.Finish();
    return config;
  } catch (const yaml::YamlError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace wirepose::app
