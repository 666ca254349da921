#include "hal/dataset/dataset.h"

#include <Eigen/LU>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include "hal/dataset/json_file.h"

namespace wirepose::dataset {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kRotationTolerance = 1e-3;

// Leaves the reader at the first thing that is wrong; caught in ReadDataset.
struct Malformed {
  std::string message;
};

// "000012" -> 12; nothing for a name that is no plain number.
std::optional<int> NumberOf(const std::string& name) {
  int number = 0;
  const char* end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data(), end, number);
  if (error != std::errc() || stop != end || number < 0) return std::nullopt;
  return number;
}

std::string SixDigits(int number) {
  char text[16];
  std::snprintf(text, sizeof text, "%06d", number);
  return text;
}

std::vector<fs::directory_entry> Entries(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator it(folder, error);
  if (error) throw Malformed{folder.string() + ": cannot be listed: " + error.message()};
  return {begin(it), end(it)};
}

// One of a scene's JSON files: an object whose keys are image ids.
class SceneFile {
 public:
  explicit SceneFile(const fs::path& path) : path_(path.string()) {
    std::error_code error;
    if (!fs::exists(path, error)) return;
    Result<json, std::string> value = ReadJson(path);
    if (!value) throw Malformed{value.error()};
    if (!value->is_object()) Fail("", "not an object with image ids as keys; see the BOP layout");
    for (const auto& [key, frame] : value->items()) {
      const std::optional<int> im_id = NumberOf(key);
      if (!im_id) Fail("key \"" + key + "\"", "not an image id; use a number");
      frames_[*im_id] = frame;
    }
  }

  [[noreturn]] void Fail(const std::string& place, const std::string& what) const {
    throw Malformed{path_ + ": " + (place.empty() ? "" : place + ": ") + what};
  }

  [[nodiscard]] const std::map<int, json>& frames() const { return frames_; }

  // The list of instances of one image; null when the file does not list the image.
  [[nodiscard]] const json* Instances(int im_id) const {
    const auto found = frames_.find(im_id);
    if (found == frames_.end()) return nullptr;
    if (!found->second.is_array()) {
      Fail("image " + std::to_string(im_id), "not a list of instances; see the BOP layout");
    }
    return &found->second;
  }

  [[nodiscard]] double Number(const json& instance, const std::string& place, const char* key) const {
    const auto found = instance.is_object() ? instance.find(key) : instance.end();
    if (found == instance.end() || !found->is_number() || !std::isfinite(found->get<double>())) {
      Fail(place, std::string(key) + " is missing or not a number; see the BOP layout");
    }
    return found->get<double>();
  }

  template <std::size_t kCount>
  [[nodiscard]] std::array<double, kCount> Numbers(const json& instance, const std::string& place,
                                                   const char* key) const {
    const auto found = instance.is_object() ? instance.find(key) : instance.end();
    std::array<double, kCount> numbers{};
    bool good = found != instance.end() && found->is_array() && found->size() == kCount;
    for (std::size_t i = 0; good && i < kCount; ++i) {
      good = (*found)[i].is_number() && std::isfinite((*found)[i].template get<double>());
      if (good) numbers[i] = (*found)[i].template get<double>();
    }
    if (!good) {
      Fail(place, std::string(key) + " is missing or not a list of " + std::to_string(kCount) +
                      " numbers; see the BOP layout");
    }
    return numbers;
  }

 private:
  std::string path_;
  std::map<int, json> frames_;
};

Pose ReadPose(const SceneFile& file, const json& instance, const std::string& place) {
  const auto R = file.Numbers<9>(instance, place, "cam_R_m2c");
  const auto t = file.Numbers<3>(instance, place, "cam_t_m2c");
  Pose T;
  T.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  T.t = Vector3d(t[0], t[1], t[2]) / 1000;  // mm
  const double deviation = (T.R * T.R.transpose() - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(deviation < kRotationTolerance) || T.R.determinant() < 0) {
    file.Fail(place, "cam_R_m2c is not a rotation matrix; see the BOP layout");
  }
  return T;
}

void ReadTruth(const SceneFile& gt, const SceneFile& info, FrameEntry& frame) {
  const json* instances = gt.Instances(frame.im_id);
  if (instances == nullptr) return;
  frame.has_truth = true;
  const json* infos = info.Instances(frame.im_id);
  const std::string image = "image " + std::to_string(frame.im_id);
  if (infos != nullptr && infos->size() != instances->size()) {
    info.Fail(image, "lists another number of instances than scene_gt_cam1.json; write both again");
  }
  for (std::size_t i = 0; i < instances->size(); ++i) {
    const std::string place = image + ", instance " + std::to_string(i);
    const json& instance = (*instances)[i];
    TrueInstance truth;
    const double obj_id = gt.Number(instance, place, "obj_id");
    if (obj_id != std::floor(obj_id) || obj_id < 0 || obj_id > 1e9) {
      gt.Fail(place, "obj_id is not a whole number; see the BOP layout");
    }
    truth.obj_id = static_cast<int>(obj_id);
    truth.T_camera_model = ReadPose(gt, instance, place);
    if (infos != nullptr) truth.visib_fract = info.Number((*infos)[i], place, "visib_fract");
    frame.gt.push_back(truth);
  }
}

void AddImageIds(const fs::path& folder, std::set<int>& im_ids) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return;
  for (const fs::directory_entry& entry : Entries(folder)) {
    if (entry.path().extension() != ".png") continue;
    const std::optional<int> im_id = NumberOf(entry.path().stem().string());
    if (im_id) im_ids.insert(*im_id);
  }
}

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

std::vector<FrameEntry> ReadFrames(const fs::path& folder) {
  std::map<int, fs::path> scenes;
  for (const fs::directory_entry& entry : Entries(folder)) {
    const std::optional<int> scene_id = NumberOf(entry.path().filename().string());
    std::error_code error;
    if (!scene_id || !entry.is_directory(error)) continue;
    if (!scenes.emplace(*scene_id, entry.path()).second) {
      throw Malformed{entry.path().string() + ": two folders for scene " + std::to_string(*scene_id) + "; rename one"};
    }
  }
  std::vector<FrameEntry> frames;
  for (const auto& [scene_id, path] : scenes) ReadScene(path, scene_id, frames);
  return frames;
}

}  // namespace

Result<Dataset, std::string> ReadDataset(const fs::path& root, const std::string& split) {
  std::error_code error;
  if (!fs::is_directory(root, error)) {
    return unexpected(root.string() + ": no such data set folder; check the path");
  }
  Dataset dataset;
  dataset.root = root;
  const Result<StereoCalibration, std::string> calibration = ReadCalibration(root / "calib.yaml");
  if (!calibration) return unexpected(calibration.error());
  dataset.calibration = *calibration;
  const fs::path folder = root / split;
  if (!fs::is_directory(folder, error)) {
    return unexpected(folder.string() + ": no such folder; scenes are expected in it");
  }
  try {
    dataset.frames = ReadFrames(folder);
  } catch (const Malformed& e) {
    return unexpected(e.message);
  } catch (const fs::filesystem_error& e) {
    return unexpected(folder.string() + ": cannot be listed: " + e.code().message());
  }
  if (dataset.frames.empty()) {
    return unexpected(folder.string() +
                      ": data set is empty; stereo pairs are expected in SSSSSS/gray_cam1 and "
                      "SSSSSS/gray_cam2 as IIIIII.png");
  }
  return dataset;
}

fs::path ModelPath(const fs::path& root, int obj_id) { return root / "models" / ("obj_" + SixDigits(obj_id) + ".ply"); }

}  // namespace wirepose::dataset
