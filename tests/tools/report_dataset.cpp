#include "report_dataset.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "eval_dataset.h"
#include "golden/golden_frames.h"
#include "hal/dataset/dataset_writer.h"
#include "tools/evaluation/results_csv.h"

namespace wirepose::evaluation::testing {
namespace {

namespace fs = std::filesystem;
using wirepose::testing::GoldenCalibration;
using wirepose::testing::GoldenFrame;
using wirepose::testing::kGoldenFrames;

constexpr int kScene = 1;

dataset::InstanceRecord Instance(int object_id, const Pose& T) {
  dataset::InstanceRecord record;
  record.obj_id = object_id;
  record.T_left_model = T;
  record.visib_fract = 1;
  return record;
}

// What the detections make of the frames' truth; see WriteReportDataset.
std::vector<dataset::FrameRecord> InventTruth(const std::vector<Estimate>& detections) {
  std::vector<dataset::FrameRecord> frames(kGoldenFrames);
  for (int i = 0; i < kGoldenFrames; ++i) frames[static_cast<std::size_t>(i)].im_id = i;
  int n = 0;
  for (const Estimate& e : detections) {
    auto& instances = frames[static_cast<std::size_t>(e.image_id)].instances;
    Pose T{e.T_camera_model.R, e.T_camera_model.t_mm / 1000};
    const int kind = n++ % 3;
    if (kind == 1) T.t.x() += 0.08;
    if (kind != 2) instances.push_back(Instance(e.object_id, T));
  }
  frames[0].instances.push_back(Instance(4, {Matrix3d::Identity(), Vector3d(0, 0, 3)}));
  return frames;
}

void WriteFrames(const fs::path& root, const std::vector<dataset::FrameRecord>& frames) {
  auto writer = dataset::DatasetWriter::Create(root, GoldenCalibration());
  ASSERT_TRUE(writer) << writer.error();
  for (const dataset::FrameRecord& frame : frames) {
    const auto images = GoldenFrame(frame.im_id);
    ASSERT_TRUE(writer->AddFrame(kScene, frame, images.left.view(), images.right.view(), {}));
  }
  ASSERT_TRUE(writer->FinishScene(kScene));
  const char* names[] = {"parcel_box", "book", "juice_dispenser", "refrigerator"};
  for (int id = 1; id <= 4; ++id) {
    fs::copy_file(fs::path(WIREPOSE_MODELS) / fmt::format("{}.ply", names[id - 1]),
                  root / fmt::format("models/obj_{:06d}.ply", id));
  }
  WriteText(
      root / "models/models_info.json",
      R"({"1": {"diameter": 390.5}, "2": {"diameter": 293.3}, "3": {"diameter": 567.5}, "4": {"diameter": 1726.9}})");
}

void BuildModels(const fs::path& folder) {
  fs::create_directory(folder / "models");
  const std::string names[] = {"parcel_box", kHostileName, "juice_dispenser"};
  for (int id = 1; id <= 3; ++id) {
    const auto built =
        RunIn(folder, fmt::format("'{}' model build none/models/obj_{:06d}.ply --id {} --name '{}' --out models/{}.wpm",
                                  WIREPOSE_PROGRAM, id, id, names[id - 1], id));
    ASSERT_EQ(built.status, 0) << built.err;
  }
}

}  // namespace

std::string TextOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

CommandOutcome RunIn(const fs::path& folder, const std::string& command) {
  const std::string all = fmt::format("cd '{}' && {} >out.txt 2>err.txt", folder.string(), command);
  const int status = std::system(all.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, TextOf(folder / "out.txt"), TextOf(folder / "err.txt")};
}

void WriteReportDataset(const fs::path& folder) {
  WriteFrames(folder / "none", InventTruth({}));
  ASSERT_NO_FATAL_FAILURE(BuildModels(folder));
  const auto run = RunIn(folder, fmt::format("'{}' eval none --models models --out none.csv", WIREPOSE_PROGRAM));
  ASSERT_EQ(run.status, 0) << run.err;
  const auto detections = ReadResults(folder / "none.csv");
  ASSERT_TRUE(detections) << detections.error();
  ASSERT_GE(detections->size(), 3U) << "the golden frames no longer show enough for a hit, a miss and a false alarm";
  WriteFrames(folder / "set", InventTruth(*detections));
}

}  // namespace wirepose::evaluation::testing
