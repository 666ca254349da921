#include "sim_command.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "command.h"
#include "hal/dataset/calibration_file.h"
#include "hal/dataset/dataset_writer.h"
#include "sim/kitchen_video.h"
#include "sim/target_mesh.h"

namespace wirepose::cli {
namespace {

struct RenderArguments {
  std::filesystem::path out;
  std::filesystem::path models = "models";
  std::filesystem::path calibration;  // empty: the simulator's own rig
  int frames = 10;
  int scenes = 1;
  int samples = 16;
  std::uint64_t seed = 1;
  double frame_rate_hz = 30;
  int threads = 2;
};

template <typename T>
T OrFail(Result<T, std::string> result) {
  if (!result) throw WorkFailed(result.error());
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

void RenderScene(const RenderArguments& arguments, const StereoCalibration& calibration, int scene_id,
                 const std::vector<sim::TargetMesh>& targets, dataset::DatasetWriter& writer) {
  sim::VideoConfig config;
  config.seed = arguments.seed + static_cast<std::uint64_t>(scene_id - 1);
  config.calibration = calibration;
  config.frame_rate_hz = arguments.frame_rate_hz;
  config.samples_per_side = static_cast<int>(std::lround(std::sqrt(arguments.samples)));
  config.threads = arguments.threads;
  const sim::KitchenVideo video = OrFail(sim::KitchenVideo::Create(config, targets));
  for (int i = 0; i < arguments.frames; ++i) {
    const auto sequence = static_cast<std::uint64_t>(i);
    const sim::StereoShot shot = video.Shoot(sequence);
    const dataset::DepthImage depth = sim::ToDepthImage(shot.truth);
    OrFail(writer.AddFrame(scene_id, sim::ToRecord(i, video.RigAt(sequence), shot.truth), shot.left.view(),
                           shot.right.view(), depth.view()));
    std::printf("scene %d frame %d/%d\n", scene_id, i + 1, arguments.frames);
    std::fflush(stdout);
  }
  OrFail(writer.FinishScene(scene_id));
}

void Render(const RenderArguments& arguments) {
  const std::vector<sim::TargetMesh> targets = OrFail(sim::LoadTargetMeshes(arguments.models));
  const StereoCalibration calibration = arguments.calibration.empty()
                                            ? sim::DefaultCalibration()
                                            : OrFail(dataset::ReadCalibration(arguments.calibration));
  dataset::DatasetWriter writer = OrFail(dataset::DatasetWriter::Create(arguments.out, calibration));
  OrFail(sim::WriteTargetMeshes(arguments.out, targets));
  for (int scene = 1; scene <= arguments.scenes; ++scene) {
    RenderScene(arguments, calibration, scene, targets, writer);
  }
  std::printf("wrote %s: %d scenes of %d frames\n", arguments.out.c_str(), arguments.scenes, arguments.frames);
}

}  // namespace

void AddSimCommand(CLI::App& app) {
  CLI::App* sim = app.add_subcommand("sim", "Simulated stereo camera");
  sim->require_subcommand(1);
  CLI::App* render =
      sim->add_subcommand("render", "Render kitchen counters with the objects on them as a data set with exact truth");
  const auto arguments = std::make_shared<RenderArguments>();
  render->add_option("--out", arguments->out, "Folder of the new data set")->required();
  render->add_option("--models", arguments->models, "Folder of meshes (PLY, OBJ, STL; mm)")->capture_default_str();
  render->add_option("--calibration", arguments->calibration,
                     "calib.yaml of the rig to simulate; none: the simulator's own");
  render->add_option("--frames", arguments->frames, "Frames a scene; the camera moves slowly")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  render->add_option("--scenes", arguments->scenes, "Scenes, each with the next seed")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  render
      ->add_option("--seed", arguments->seed,
                   "Seed of the first scene; the same seed gives the "
                   "same bytes")
      ->capture_default_str();
  render->add_option("--rate", arguments->frame_rate_hz, "Frames per second of the moving camera")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  render->add_option("--samples", arguments->samples, "Samples per pixel")
      ->check(CLI::IsMember({4, 9, 16, 25, 36}))
      ->capture_default_str();
  render->add_option("--threads", arguments->threads, "Threads; no influence on the result")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  render->callback([arguments] { Render(*arguments); });
}

}  // namespace wirepose::cli
