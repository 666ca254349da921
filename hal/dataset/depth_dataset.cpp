#include "hal/dataset/depth_dataset.h"

#include <algorithm>
#include <system_error>

#include "hal/dataset/scene_files.h"

namespace wirepose::dataset {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Row-major cam_K, as the file has it.
using CameraMatrix = std::array<double, 9>;

class SceneReaderWithDepth {
 public:
  void operator()(const fs::path& folder, int scene_id, std::vector<FrameEntry>& frames) {
    std::error_code error;
    if (!fs::exists(folder / "scene_camera.json", error)) {
      throw Malformed{(folder / "scene_camera.json").string() + ": is missing; it lists the images and their cam_K"};
    }
    const SceneFile camera(folder / "scene_camera.json");
    const SceneFile gt(folder / "scene_gt.json");
    const SceneFile info(folder / "scene_gt_info.json");
    const fs::path images = folder / (fs::is_directory(folder / "rgb", error) ? "rgb" : "gray");
    for (const auto& [im_id, value] : camera.frames()) {
      FrameEntry frame;
      frame.scene_id = scene_id;
      frame.im_id = im_id;
      frame.left_path = images / (SixDigits(im_id) + ".png");
      frame.depth_path = folder / "depth" / (SixDigits(im_id) + ".png");
      ReadCamera(camera, value, frame);
      ReadTruth(gt, info, frame);
      frames.push_back(std::move(frame));
    }
  }

  [[nodiscard]] const CameraMatrix& K() const { return K_; }

 private:
  void ReadCamera(const SceneFile& file, const json& value, FrameEntry& frame) {
    const std::string place = "image " + std::to_string(frame.im_id);
    const CameraMatrix K = file.Numbers<9>(value, place, "cam_K");
    if (!(K[0] > 0 && K[4] > 0) || K[1] != 0 || K[3] != 0 || K[6] != 0 || K[7] != 0 || K[8] != 1) {
      file.Fail(place,
                "cam_K is not of the form fx 0 cx 0 fy cy 0 0 1 with positive focal lengths; skew is not supported");
    }
    if (!first_.empty() && K != K_) {
      file.Fail(place, "cam_K differs from that of " + first_ + "; one camera a data set: divide it");
    }
    if (first_.empty()) {
      first_ = "scene " + std::to_string(frame.scene_id) + " image " + std::to_string(frame.im_id);
      K_ = K;
    }
    const bool has_scale = value.is_object() && value.contains("depth_scale");
    const double scale = has_scale ? file.Number(value, place, "depth_scale") : 1;
    if (!(scale > 0 && scale <= 1000)) {
      file.Fail(place, "depth_scale is not above 0 and at most 1000; it turns units of the depth image into mm");
    }
    frame.depth_unit_m = scale / 1000;
  }

  CameraMatrix K_{};
  std::string first_;  // which image K_ is from; empty: none was read yet
};

// Of the first image that is there.
Result<DepthCalibration, std::string> CameraOf(const CameraMatrix& K, const std::vector<FrameEntry>& frames) {
  for (const FrameEntry& frame : frames) {
    const auto image = ReadGrayPng(frame.left_path);
    if (!image && image.error().missing) continue;
    if (!image) return unexpected(image.error().message);
    DepthCalibration camera;
    camera.camera = {K[0], K[4], K[2], K[5]};
    camera.width = image->width;
    camera.height = image->height;
    return camera;
  }
  return unexpected(frames.front().left_path.string() +
                    ": is missing, and so is every other image; put the images there");
}

}  // namespace

bool IsDepthDataset(const fs::path& root, const std::string& split) {
  std::error_code error;
  if (fs::exists(root / "calib.yaml", error)) return false;
  fs::directory_iterator scenes(root / split, error);
  if (error) return false;
  return std::any_of(begin(scenes), end(scenes), [](const fs::directory_entry& entry) {
    std::error_code ignored;
    return NumberOf(entry.path().filename().string()) && fs::exists(entry.path() / "scene_camera.json", ignored);
  });
}

Result<Dataset, std::string> ReadDepthDataset(const fs::path& root, const std::string& split) {
  Dataset dataset;
  dataset.root = root;
  SceneReaderWithDepth reader;
  auto frames = ReadScenes(root / split, std::ref(reader));
  if (!frames) return unexpected(frames.error());
  dataset.frames = *std::move(frames);
  if (dataset.frames.empty()) {
    return unexpected((root / split).string() +
                      ": data set is empty; images are expected in SSSSSS/rgb or SSSSSS/gray and SSSSSS/depth as "
                      "IIIIII.png, listed by SSSSSS/scene_camera.json");
  }
  const auto camera = CameraOf(reader.K(), dataset.frames);
  if (!camera) return unexpected(camera.error());
  dataset.depth_camera = *camera;
  return dataset;
}

}  // namespace wirepose::dataset
