// `wireposed`: the robot program. Reads the configuration, chooses the camera, runs the recognizer,
// publishes.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>

#include "app/camera_factory.h"
#include "app/command_handler.h"
#include "app/config.h"
#include "app/failure.h"
#include "app/memory_lock.h"
#include "app/model_library.h"
#include "app/robot_loop.h"
#include "app/service.h"
#include "pipeline/recognizer.h"
#include "publish/publisher.h"

namespace wirepose::app {
namespace {

// All large memory of the program.
Recognizer g_recognizer;
ModelLibrary g_models(g_recognizer);
Publisher g_publisher;

std::atomic<bool> g_stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set by a signal handler");

struct Options {
  std::string config, camera;
  std::vector<std::filesystem::path> models;
  std::uint64_t frames = 0;
};

void StopOnSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

// The file with what the command line overrides.
Config EffectiveConfig(const Options& options) {
  Config config = LoadConfig(options.config);
  if (!options.camera.empty()) {
    config.camera.backend = ParseCameraBackend(options.camera, "--camera");
  }
  if (!options.models.empty()) config.models = options.models;
  if (config.models.empty()) {
    throw UsageError(options.config + ": models: missing; list .wpm files or folders, also as --models");
  }
  return config;
}

// Gives the recognizer the models and says which are searched for.
void AddModels(const Config& config) {
  g_models.Load(config.models);
  ModelIds ids;
  for (const std::uint32_t id : config.search_for) {
    if (ids.try_push_back(id)) continue;
    throw WorkFailed(config.file.string() + ": search_for: more than " + std::to_string(kMaxModels) +
                     " ids; remove some");
  }
  const std::string refusal = g_models.Select(ids);
  if (!refusal.empty()) throw WorkFailed(config.file.string() + ": search_for: " + refusal);
}

void CheckCamera(hal::CameraError error, const hal::StereoCamera& camera) {
  if (error == hal::CameraError::kOk) return;
  const std::string detail(camera.detail());
  throw WorkFailed(std::string(camera.name()) + " camera: " + (detail.empty() ? hal::Describe(error) : detail));
}

void OpenCamera(hal::StereoCamera& camera) {
  CheckCamera(camera.Open(), camera);
  const RecognizerError error = g_recognizer.Configure(camera.calibration());
  if (error != RecognizerError::kOk) {
    throw WorkFailed(std::string(camera.name()) + " camera: calibration: " + Describe(error));
  }
}

void Run(const Options& options) {
  const Config config = EffectiveConfig(options);
  const std::unique_ptr<hal::StereoCamera> camera = CreateCamera(config);
  AddModels(config);
  OpenCamera(*camera);
  const DdsConfig& dds = config.dds;
  const auto opened = g_publisher.Open({dds.bus, dds.frame_id, WIREPOSE_VERSION, dds.pool_bytes});
  if (!opened) throw WorkFailed(opened.error());
  if (const std::string warning = LockMemory(); !warning.empty())
    std::fprintf(stderr, "wireposed: %s\n", warning.c_str());
  CheckCamera(camera->Start(), *camera);

  const std::string status = std::string(camera->name()) + " camera, " + std::to_string(g_recognizer.models().size()) +
                             " models, DDS domain " + std::to_string(dds.bus.domain);
  std::fprintf(stderr, "wireposed: running: %s\n", status.c_str());
  Service service;
  service.Ready(status);
  CommandHandler commands(g_recognizer, g_models, camera->calibration().width, camera->calibration().height);
  const bool live = config.camera.backend == CameraBackend::kLibcamera;
  const auto loop = std::make_unique<RobotLoop>(
      RobotParts{*camera, g_recognizer, g_publisher, commands, service},
      RobotLoopConfig{config.camera.timeout, options.frames, StampClock(dds.stamp, live), config.tracking});
  loop->Run(g_stop);
  service.Stopping();
  (void)camera->Stop();
  (void)camera->Close();
  g_publisher.Close();
  std::fprintf(stderr, "wireposed: stopped after %llu frames\n", static_cast<unsigned long long>(loop->frames()));
}

// Nothing when the command line only asked for help or version, which has been printed.
std::optional<Options> ParseCommandLine(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Wirepose: recognizes known objects in a stereo camera's frames and publishes their poses on "
      "DDS"};
  app.set_version_flag("--version", WIREPOSE_VERSION);
  app.add_option("--config", options.config, "configuration, YAML")->required();
  app.add_option("--camera", options.camera, "libcamera, replay or simulated; overrides the configuration");
  app.add_option("--models", options.models, "model files (.wpm) or folders; override the configuration");
  app.add_option("--frames", options.frames, "end after that many frames; 0: never");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    app.exit(e);
    return std::nullopt;
  } catch (const CLI::ParseError& e) {
    throw UsageError(std::string(e.what()) + "; see wireposed --help");
  }
  return options;
}

}  // namespace
}  // namespace wirepose::app

int main(int argc, char** argv) {
  using namespace wirepose::app;
  try {
    const std::optional<Options> options = ParseCommandLine(argc, argv);
    if (!options) return 0;
    StopOnSignals();
    Run(*options);
    return 0;
  } catch (const UsageError& e) {
    std::fprintf(stderr, "wireposed: %s\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "wireposed: %s\n", e.what());
    return 1;
  }
}
