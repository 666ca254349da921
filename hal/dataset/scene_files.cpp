#include "hal/dataset/scene_files.h"

#include <charconv>
#include <cstdio>
#include <system_error>

#include "geometry/rotation.h"
#include "hal/dataset/json_file.h"

namespace wirepose::dataset {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<fs::directory_entry> Entries(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator it(folder, error);
  if (error) throw Malformed{folder.string() + ": cannot be listed: " + error.message()};
  return {begin(it), end(it)};
}

Pose ReadPose(const SceneFile& file, const json& instance, const std::string& place) {
  const auto R = file.Numbers<9>(instance, place, "cam_R_m2c");
  const auto t = file.Numbers<3>(instance, place, "cam_t_m2c");
  Pose T;
  T.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  T.t = Vector3d(t[0], t[1], t[2]) / 1000;  // mm
  if (!IsRotation(T.R)) {
    file.Fail(place, "cam_R_m2c is not a rotation matrix; see the BOP layout");
  }
  return T;
}

std::vector<FrameEntry> ReadFrames(const fs::path& folder, const SceneReader& read) {
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
  for (const auto& [scene_id, path] : scenes) read(path, scene_id, frames);
  return frames;
}

}  // namespace

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

SceneFile::SceneFile(const fs::path& path) : path_(path.string()) {
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

void SceneFile::Fail(const std::string& place, const std::string& what) const {
  throw Malformed{path_ + ": " + (place.empty() ? "" : place + ": ") + what};
}

const json* SceneFile::Instances(int im_id) const {
  const auto found = frames_.find(im_id);
  if (found == frames_.end()) return nullptr;
  if (!found->second.is_array()) {
    Fail("image " + std::to_string(im_id), "not a list of instances; see the BOP layout");
  }
  return &found->second;
}

double SceneFile::Number(const json& instance, const std::string& place, const char* key) const {
  const auto found = instance.is_object() ? instance.find(key) : instance.end();
  if (found == instance.end() || !found->is_number() || !std::isfinite(found->get<double>())) {
    Fail(place, std::string(key) + " is missing or not a number; see the BOP layout");
  }
  return found->get<double>();
}

void ReadTruth(const SceneFile& gt, const SceneFile& info, FrameEntry& frame) {
  const json* instances = gt.Instances(frame.im_id);
  if (instances == nullptr) return;
  frame.has_truth = true;
  const json* infos = info.Instances(frame.im_id);
  const std::string image = "image " + std::to_string(frame.im_id);
  if (infos != nullptr && infos->size() != instances->size()) {
    info.Fail(image, "lists another number of instances than " + gt.name() + "; write both again");
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

Result<std::vector<FrameEntry>, std::string> ReadScenes(const fs::path& split, const SceneReader& read) {
  std::error_code error;
  if (!fs::is_directory(split, error)) {
    return unexpected(split.string() + ": no such folder; scenes are expected in it");
  }
  try {
    return ReadFrames(split, read);
  } catch (const Malformed& e) {
    return unexpected(e.message);
  } catch (const fs::filesystem_error& e) {
    return unexpected(split.string() + ": cannot be listed: " + e.code().message());
  }
}

}  // namespace wirepose::dataset
