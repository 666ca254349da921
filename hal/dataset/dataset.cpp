#include "hal/dataset/dataset.h"

#include <system_error>

#include "hal/dataset/depth_dataset.h"
#include "hal/dataset/scene_files.h"

namespace wirepose::dataset {
namespace {

namespace fs = std::filesystem;

void ReadScene(const fs::path& folder, int scene_id, std::vector<FrameEntry>& frames) {
  const SceneFile camera(folder / "scene_camera_cam1.json");
  const SceneFile gt(folder / "scene_gt_cam1.json");
  const SceneFile info(folder / "scene_gt_info_cam1.json");
  std::set<int> im_ids;
  for (const auto& [im_id, value] : camera.frames()) im_ids.insert(im_id);
  AddImageIds(folder / "gray_cam1", im_ids);
  AddImageIds(folder / "gray_cam2", im_ids);
  for (const int im_id : im_ids) {
    FrameEntry frame;
    frame.scene_id = scene_id;
    frame.im_id = im_id;
    frame.left_path = folder / "gray_cam1" / (SixDigits(im_id) + ".png");
    frame.right_path = folder / "gray_cam2" / (SixDigits(im_id) + ".png");
    ReadTruth(gt, info, frame);
    frames.push_back(std::move(frame));
  }
}

}  // namespace

Result<Dataset, std::string> ReadDataset(const fs::path& root, const std::string& split) {
  std::error_code error;
  if (!fs::is_directory(root, error)) {
    return unexpected(root.string() + ": no such data set folder; check the path");
  }
  if (IsDepthDataset(root, split)) {
    return unexpected(root.string() +
                      ": one camera with depth (scene_camera.json, no calib.yaml), where stereo pairs are needed; "
                      "'wirepose eval' reads such data sets");
  }
  Dataset dataset;
  dataset.root = root;
  const Result<StereoCalibration, std::string> calibration = ReadCalibration(root / "calib.yaml");
  if (!calibration) return unexpected(calibration.error());
  dataset.calibration = *calibration;
  auto frames = ReadScenes(root / split, ReadScene);
  if (!frames) return unexpected(frames.error());
  dataset.frames = *std::move(frames);
  if (dataset.frames.empty()) {
    return unexpected((root / split).string() +
                      ": data set is empty; stereo pairs are expected in SSSSSS/gray_cam1 and "
                      "SSSSSS/gray_cam2 as IIIIII.png");
  }
  return dataset;
}

fs::path ModelPath(const fs::path& root, int obj_id) { return root / "models" / ("obj_" + SixDigits(obj_id) + ".ply"); }

}  // namespace wirepose::dataset
