#include "sim_command.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "command.h"
#include "hal/dataset/calibration_file.h"
#include "sim/scenario_file.h"
#include "sim/suite.h"
#include "sim/target_mesh.h"

namespace wirepose::cli {
namespace {

namespace fs = std::filesystem;

struct RenderArguments {
  fs::path out;
  fs::path models = "models";
  fs::path scenario;     // empty: the built-in kitchen
  fs::path calibration;  // empty: the scenario's rig
  std::optional<int> frames, scenes, samples;
  std::optional<std::uint64_t> seed;
  std::optional<double> rate_hz;
  int threads = 0;  // 0: all cores
};

struct SuiteArguments {
  fs::path out;
  fs::path models = "models";
  fs::path scenarios = "sim/scenarios";
  std::vector<std::string> only;
  int threads = 0;
};

template <typename T>
T OrFail(Result<T, std::string> result) {
  if (!result) throw WorkFailed(result.error());
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

int Threads(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::string Minutes(double seconds) {
  const int whole = static_cast<int>(seconds + 0.5);
  char text[32];
  std::snprintf(text, sizeof text, "%d:%02d", whole / 60, whole % 60);
  return text;
}

// One line every two seconds, and the last.
class ProgressPrinter {
 public:
  void operator()(const sim::RenderProgress& p) {
    if (p.done < p.total && p.elapsed_s < next_s_) return;
    next_s_ = p.elapsed_s + 2;
    std::printf("%d of %d frames, %s left (%s)\n", p.done, p.total, Minutes(p.left_s).c_str(), p.name.c_str());
    std::fflush(stdout);
  }

 private:
  double next_s_ = 0;
};

void Run(const std::vector<sim::RenderJob>& jobs, const fs::path& models, int threads) {
  const std::vector<sim::TargetMesh> targets = OrFail(sim::LoadTargetMeshes(models));
  ProgressPrinter printer;
  OrFail(sim::RenderDatasets(jobs, targets, Threads(threads), [&](const sim::RenderProgress& p) { printer(p); }));
  for (const sim::RenderJob& job : jobs) {
    std::printf("%s: %d scenes of %d frames, contact_sheet.png\n", job.root.c_str(), job.spec.scenes, job.spec.frames);
  }
}

void Render(const RenderArguments& arguments) {
  sim::ScenarioSpec spec;
  if (!arguments.scenario.empty()) spec = OrFail(sim::ReadScenario(arguments.scenario));
  if (!arguments.calibration.empty()) spec.camera.calibration = OrFail(dataset::ReadCalibration(arguments.calibration));
  spec.frames = arguments.frames.value_or(arguments.scenario.empty() ? 10 : spec.frames);
  spec.scenes = arguments.scenes.value_or(spec.scenes);
  spec.samples = arguments.samples.value_or(spec.samples);
  spec.seed = arguments.seed.value_or(spec.seed);
  spec.rate_hz = arguments.rate_hz.value_or(spec.rate_hz);
  Run({{spec, arguments.out}}, arguments.models, arguments.threads);
}

std::vector<fs::path> ScenarioFiles(const SuiteArguments& arguments) {
  std::error_code error;
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(arguments.scenarios, error)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) {
    throw UsageError(arguments.scenarios.string() + ": no scenario (.yaml) in it; name the folder with --scenarios");
  }
  if (arguments.only.empty()) return files;
  std::vector<fs::path> chosen;
  for (const std::string& name : arguments.only) {
    const auto found = std::find_if(files.begin(), files.end(), [&](const fs::path& f) { return f.stem() == name; });
    if (found == files.end())
      throw UsageError("--only " + name + ": no such scenario in " + arguments.scenarios.string());
    chosen.push_back(*found);
  }
  return chosen;
}

void Suite(const SuiteArguments& arguments) {
  std::vector<sim::RenderJob> jobs;
  for (const fs::path& file : ScenarioFiles(arguments)) {
    const sim::ScenarioSpec spec = OrFail(sim::ReadScenario(file));
    jobs.push_back({spec, arguments.out / spec.name});
  }
  Run(jobs, arguments.models, arguments.threads);
}

void AddRender(CLI::App& sim) {
  CLI::App* render = sim.add_subcommand("render", "Render one scenario as a data set with exact truth");
  const auto a = std::make_shared<RenderArguments>();
  render->add_option("--out", a->out, "Folder of the data set; what is complete in it stays")->required();
  render->add_option("--scenario", a->scenario, "Scenario file (sim/README.md); none: a kitchen with some objects");
  render->add_option("--models", a->models, "Folder of meshes (PLY, OBJ, STL; mm)")->capture_default_str();
  render->add_option("--calibration", a->calibration, "calib.yaml of the rig to simulate; none: the scenario's");
  render->add_option("--frames", a->frames, "Frames a scene; the camera moves")->check(CLI::Range(1, 100000));
  render->add_option("--scenes", a->scenes, "Scenes, each with the next seed")->check(CLI::Range(1, 100000));
  render->add_option("--seed", a->seed, "Seed of the first scene; the same seed gives the same bytes");
  render->add_option("--rate", a->rate_hz, "Frames per second of the moving camera")->check(CLI::Range(1.0, 1000.0));
  render->add_option("--samples", a->samples, "Samples per pixel")->check(CLI::IsMember({4, 9, 16, 25, 36}));
  render->add_option("--threads", a->threads, "Threads, no influence on the result; 0: all cores")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  render->callback([a] { Render(*a); });
}

void AddSuite(CLI::App& sim) {
  CLI::App* suite = sim.add_subcommand("suite", "Render all scenarios of a folder, each as a data set of its name");
  const auto a = std::make_shared<SuiteArguments>();
  suite->add_option("--out", a->out, "Folder of the data sets; what is complete in it stays")->required();
  suite->add_option("--only", a->only, "Names of scenarios; none: all");
  suite->add_option("--scenarios", a->scenarios, "Folder of scenario files")->capture_default_str();
  suite->add_option("--models", a->models, "Folder of meshes (PLY, OBJ, STL; mm)")->capture_default_str();
  suite->add_option("--threads", a->threads, "Threads, no influence on the result; 0: all cores")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  suite->callback([a] { Suite(*a); });
}

}  // namespace

void AddSimCommand(CLI::App& app) {
  CLI::App* sim = app.add_subcommand("sim", "Simulated stereo camera");
  sim->require_subcommand(1);
  AddRender(*sim);
  AddSuite(*sim);
}

}  // namespace wirepose::cli
