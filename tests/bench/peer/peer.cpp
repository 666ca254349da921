#include "peer.h"

#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include <fmt/format.h>

#include "hal/dataset/dataset.h"
#include "mesh/mesh_reader.h"
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
                    const FoundPose& pose) {
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

using Searches = std::map<int, std::unique_ptr<ObjectSearch>>;

Searches Train(const Arguments& arguments, const GroundTruth& truth, const TrainFunction& train) {
  Searches searches;
  for (const auto& [id, object] : truth.objects) {
    const double start = CpuSeconds();
    const auto mesh = OrThrow(mesh::ReadMesh(dataset::ModelPath(arguments.dataset, id), 0.001));
    searches[id] = train(mesh, object);
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
    for (const FoundPose& p : search->Find(cloud, kPosesPerObject)) {
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

void Run(const Arguments& arguments, const TrainFunction& train) {
  cv::setNumThreads(1);
  auto set = OrThrow(dataset::ReadDataset(arguments.dataset));
  GroundTruth truth = OrThrow(evaluation::ReadGroundTruth(arguments.dataset));
  if (arguments.limit > 0 && set.frames.size() > arguments.limit) set.frames.resize(arguments.limit);
  std::set<std::pair<int, int>> kept;
  for (const auto& f : set.frames) kept.insert({f.scene_id, f.im_id});
  evaluation::KeepFrames(kept, truth);
  const Searches searches = Train(arguments, truth, train);
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

void KeepBest(std::vector<FoundPose>& poses, std::size_t most) {
  std::stable_sort(poses.begin(), poses.end(), [](const auto& p, const auto& q) { return p.score > q.score; });
  if (poses.size() > most) poses.resize(most);
}

std::vector<FoundPose> KeepApart(std::vector<FoundPose> poses, double distance_m, std::size_t most) {
  KeepBest(poses, poses.size());
  std::vector<FoundPose> apart;
  for (const FoundPose& p : poses) {
    const auto near = [&](const FoundPose& q) { return cv::norm(p.t - q.t) < distance_m; };
    if (apart.size() < most && std::none_of(apart.begin(), apart.end(), near)) apart.push_back(p);
  }
  return apart;
}

int PeerMain(int argc, char** argv, const char* program, const char* description, const TrainFunction& train) {
  Arguments arguments;
  CLI::App app{description};
  app.add_option("dataset", arguments.dataset)->required();
  app.add_option("--out", arguments.out, "BOP results (CSV)")->required();
  app.add_option("--json", arguments.json, "Measures (JSON)")->required();
  app.add_option("--limit", arguments.limit, "Stop after so many frames (0: all)");
  CLI11_PARSE(app, argc, argv);
  try {
    Run(arguments, train);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", program, e.what());
    return 1;
  }
  return 0;
}

}  // namespace wirepose::bench
