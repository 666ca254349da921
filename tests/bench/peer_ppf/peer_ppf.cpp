// peer_ppf DATASET --out results.csv --json metrics.json [--limit N]: OpenCV's point-pair features on a data set.
//
// Every object of the data set is searched for in every frame, up to three poses each. The rows written are those above
// the score that, known afterwards, gives the best harmonic mean of recall and precision: kinder than any user could
// be.
#include <time.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include <fmt/format.h>

#include "hal/dataset/dataset.h"
#include "mesh/mesh_reader.h"
#include "surface_search.h"
#include "tools/evaluation/metrics_json.h"
#include "tools/evaluation/results_csv.h"
#include "tools/evaluation/score_curves.h"

namespace wirepose::bench {
namespace {

using evaluation::Estimate;
using evaluation::GroundTruth;
using evaluation::Metrics;

constexpr std::size_t kPosesPerObject = 3;

struct Arguments {
  std::filesystem::path dataset, out, json;
  std::size_t limit = 0;  // frames; 0: all
};

template <typename T>
T OrThrow(Result<T, std::string> result) {
  if (!result) throw std::runtime_error(result.error());
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

double CpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

cv::Mat ReadImage(const std::filesystem::path& file) {
  cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (image.empty()) throw std::runtime_error(file.string() + ": cannot be read as an image; restore it");
  return image;
}

Estimate ToEstimate(const dataset::FrameEntry& entry, int object_id, const cv::Matx33d& R_raw_rectified,
                    const SurfacePose& pose) {
  Estimate e;
  e.scene_id = entry.scene_id;
  e.image_id = entry.im_id;
  e.object_id = object_id;
  e.score = pose.score;
  const cv::Matx33d R = R_raw_rectified * pose.R;
  const cv::Vec3d t = R_raw_rectified * pose.t * 1000.0;
  for (int i = 0; i < 9; ++i) e.T_camera_model.R(i / 3, i % 3) = R.val[i];
  e.T_camera_model.t_mm = {t[0], t[1], t[2]};
  return e;
}

using Searches = std::map<int, std::unique_ptr<SurfaceSearch>>;

Searches Train(const Arguments& arguments, const GroundTruth& truth) {
  Searches searches;
  for (const auto& [id, object] : truth.objects) {
    const double start = CpuSeconds();
    const auto mesh = OrThrow(mesh::ReadMesh(dataset::ModelPath(arguments.dataset, id), 0.001));
    searches[id] = std::make_unique<SurfaceSearch>(mesh, object);
    std::printf("object %d: trained in %.1f s\n", id, CpuSeconds() - start);
    std::fflush(stdout);
  }
  return searches;
}

std::vector<Estimate> Search(const dataset::FrameEntry& entry, const StereoRig& rig, const Searches& searches) {
  const auto pair = rig.Rectify(ReadImage(entry.left_path), ReadImage(entry.right_path));
  const double start = CpuSeconds();
  const DenseCloud cloud = MakeCloud(rig, pair);
  std::vector<Estimate> found;
  for (const auto& [id, search] : searches) {
    for (const SurfacePose& p : search->Find(cloud, kPosesPerObject)) {
      found.push_back(ToEstimate(entry, id, rig.R_raw_rectified, p));
    }
  }
  const double time_s = CpuSeconds() - start;
  for (Estimate& e : found) e.time_s = time_s;
  std::printf("scene %d image %d: %.1f s\n", entry.scene_id, entry.im_id, time_s);
  std::fflush(stdout);
  return found;
}

// The threshold with the best harmonic mean of precision and recall; above all scores when nothing is right.
double BestThreshold(const std::vector<Estimate>& found, const Metrics& metrics) {
  double best = 0, threshold = 2;
  for (const auto& p :
       evaluation::ScoreCurve(evaluation::CountedDetections(found, metrics), metrics.total.all.instances)) {
    if (p.precision + p.recall <= 0) continue;
    const double mean = 2 * p.precision * p.recall / (p.precision + p.recall);
    if (mean <= best) continue;
    best = mean;
    threshold = p.threshold;
  }
  return threshold;
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  auto set = OrThrow(dataset::ReadDataset(arguments.dataset));
  GroundTruth truth = OrThrow(evaluation::ReadGroundTruth(arguments.dataset));
  if (arguments.limit > 0 && set.frames.size() > arguments.limit) set.frames.resize(arguments.limit);
  std::set<std::pair<int, int>> kept;
  for (const auto& f : set.frames) kept.insert({f.scene_id, f.im_id});
  evaluation::KeepFrames(kept, truth);
  const Searches searches = Train(arguments, truth);
  const StereoRig rig(arguments.dataset / "calib.yaml");
  std::vector<Estimate> found;
  std::vector<double> times_s;
  for (const auto& entry : set.frames) {
    const double start = CpuSeconds();
    for (Estimate& e : Search(entry, rig, searches)) found.push_back(std::move(e));
    times_s.push_back(CpuSeconds() - start);
  }
  const Metrics all = evaluation::ComputeMetrics(truth, found);
  const double threshold = BestThreshold(found, all);
  std::erase_if(found, [&](const Estimate& e) { return e.score < threshold; });
  auto json = evaluation::ToJson(evaluation::ComputeMetrics(truth, found));
  json["best_threshold"] = threshold;
  json["recall_of_three_poses"] = all.total.all.Recall().value_or(0);
  for (const double s : times_s) json["per_frame"].push_back({{"cpu_s", s}});
  OrThrow(evaluation::WriteResults(arguments.out, found));
  std::ofstream out(arguments.json);
  out << json.dump(1) << '\n';
  out.close();
  if (!out) throw std::runtime_error(arguments.json.string() + ": cannot be written; check the folder");
  std::printf("recall of any of three poses %.2f; above score %.2f: %d hits, %d false\n",
              all.total.all.Recall().value_or(0), threshold, json["total"]["true_positives"].get<int>(),
              json["total"]["false_positives"].get<int>());
}

}  // namespace
}  // namespace wirepose::bench

int main(int argc, char** argv) {
  wirepose::bench::Arguments arguments;
  CLI::App app{"OpenCV's surface_matching on a data set, for comparison"};
  app.add_option("dataset", arguments.dataset)->required();
  app.add_option("--out", arguments.out, "BOP results (CSV)")->required();
  app.add_option("--json", arguments.json, "Measures (JSON)")->required();
  app.add_option("--limit", arguments.limit, "Stop after so many frames (0: all)");
  CLI11_PARSE(app, argc, argv);
  try {
    wirepose::bench::Run(arguments);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "peer_ppf: %s\n", e.what());
    return 1;
  }
  return 0;
}
