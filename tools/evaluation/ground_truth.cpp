#include "tools/evaluation/ground_truth.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/evaluation/ply_vertices.h"
#include "tools/evaluation/pose_error.h"

namespace wirepose::evaluation {
namespace {

namespace fs = std::filesystem;
using InputJson = nlohmann::json;

// Malformed data, caught by ReadGroundTruth: many places can find it, one reports it.
struct BadData : std::runtime_error {
  using std::runtime_error::runtime_error;
};

InputJson ReadJson(const fs::path& file) {
  std::ifstream in(file);
  if (!in) {
    throw BadData(fmt::format("{}: cannot be opened; the data set layout asks for it", file.string()));
  }
  try {
    return InputJson::parse(in);
  } catch (const InputJson::parse_error& e) {
    throw BadData(fmt::format("{}: byte {}: not valid JSON; repair or export it again", file.string(), e.byte));
  }
}

// A JSON value with the words that name its place, for error messages.
struct Place {
  const InputJson& value;
  std::string where;

  [[noreturn]] void Fail(const std::string& what) const {
    throw BadData(fmt::format("{}: {}; see the BOP data set format", where, what));
  }
  [[nodiscard]] bool Has(const std::string& key) const { return value.is_object() && value.contains(key); }
  [[nodiscard]] Place At(const std::string& key) const {
    if (!Has(key)) Fail(fmt::format("'{}' is missing", key));
    return {value.at(key), where + ": " + key};
  }
  [[nodiscard]] double Number() const {
    if (!value.is_number()) Fail("a number is expected");
    return value.get<double>();
  }
  [[nodiscard]] std::vector<double> Numbers(std::size_t count) const {
    if (!value.is_array() || value.size() != count) Fail(fmt::format("{} numbers are expected", count));
    std::vector<double> out;
    for (const InputJson& n : value) {
      if (!n.is_number()) Fail(fmt::format("{} numbers are expected", count));
      out.push_back(n.get<double>());
    }
    return out;
  }
  [[nodiscard]] Matrix3d Matrix() const {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(Numbers(9).data());
  }
  [[nodiscard]] Vector3d Vector() const { return Eigen::Map<const Vector3d>(Numbers(3).data()); }
};

std::optional<int> ParseId(const std::string& text) {
  int id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc{} || end != text.data() + text.size() || id < 0) return std::nullopt;
  return id;
}

int IdOf(const std::string& key, const std::string& where) {
  const std::optional<int> id = ParseId(key);
  if (!id) throw BadData(fmt::format("{}: '{}' is not an id; ids are whole numbers", where, key));
  return *id;
}

RigidMm ReadDiscrete(const Place& place) {
  const std::vector<double> n = place.Numbers(16);
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(n.data());
  return {m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>()};
}

ObjectTruth ReadObject(const Place& info, const fs::path& mesh) {
  ObjectTruth object;
  object.diameter_mm = info.At("diameter").Number();
  if (!(object.diameter_mm > 0)) info.Fail("'diameter' must be positive");
  std::vector<RigidMm> discrete;
  std::vector<ContinuousSymmetry> continuous;
  if (info.Has("symmetries_discrete")) {
    const Place list = info.At("symmetries_discrete");
    for (const InputJson& s : list.value) discrete.push_back(ReadDiscrete({s, list.where}));
  }
  if (info.Has("symmetries_continuous")) {
    const Place list = info.At("symmetries_continuous");
    for (const InputJson& s : list.value) {
      const Place p{s, list.where};
      continuous.push_back({p.At("axis").Vector(), p.Has("offset") ? p.At("offset").Vector() : Vector3d::Zero()});
    }
  }
  object.symmetries = EnumerateSymmetries(discrete, continuous);
  object.continuous = !continuous.empty();
  auto vertices = ReadPlyVertices(mesh);
  if (!vertices) throw BadData(vertices.error());
  object.vertices_mm = std::move(*vertices);
  return object;
}

std::map<int, ObjectTruth> ReadObjects(const fs::path& models) {
  const fs::path file = models / "models_info.json";
  const InputJson json = ReadJson(file);
  if (!json.is_object() || json.empty()) throw BadData(file.string() + ": no objects; list each by its id");
  std::map<int, ObjectTruth> objects;
  for (const auto& [key, info] : json.items()) {
    const int id = IdOf(key, file.string());
    const Place place{info, fmt::format("{}: object {}", file.string(), id)};
    objects.emplace(id, ReadObject(place, models / fmt::format("obj_{:06d}.ply", id)));
  }
  return objects;
}

// The files of one scene; `suffix` is "_cam1" in the layout with two cameras.
struct SceneFiles {
  fs::path camera, gt, gt_info;
  SceneFiles(const fs::path& scene, const std::string& suffix)
      : camera(scene / ("scene_camera" + suffix + ".json")),
        gt(scene / ("scene_gt" + suffix + ".json")),
        gt_info(scene / ("scene_gt_info" + suffix + ".json")) {}
};

std::vector<InstanceTruth> ReadInstances(const Place& gt, const std::optional<Place>& info,
                                         const std::map<int, ObjectTruth>& objects) {
  if (!gt.value.is_array()) gt.Fail("a list of instances is expected");
  if (info && (!info->value.is_array() || info->value.size() != gt.value.size())) {
    info->Fail(fmt::format("{} entries are expected, one an instance", gt.value.size()));
  }
  std::vector<InstanceTruth> out;
  for (std::size_t i = 0; i < gt.value.size(); ++i) {
    const Place p{gt.value[i], fmt::format("{}: instance {}", gt.where, i)};
    InstanceTruth& instance = out.emplace_back();
    instance.object_id = static_cast<int>(p.At("obj_id").Number());
    if (!objects.contains(instance.object_id)) {
      p.Fail(fmt::format("unknown model id {}: models/models_info.json has no such object", instance.object_id));
    }
    instance.T_camera_model = {p.At("cam_R_m2c").Matrix(), p.At("cam_t_m2c").Vector()};
    if (!info) continue;
    const Place q{info->value[i], fmt::format("{}: instance {}", info->where, i)};
    instance.visible_fraction = q.At("visib_fract").Number();
  }
  return out;
}

void ReadScene(const fs::path& scene, int scene_id, GroundTruth& truth) {
  // A stereo scene whose camera file is lost must be told so by that file's name.
  const bool stereo = fs::exists(scene / "gray_cam1") || fs::exists(scene / "scene_camera_cam1.json");
  const std::string suffix = stereo ? "_cam1" : "";
  const SceneFiles files(scene, suffix);
  const InputJson cameras = ReadJson(files.camera);
  const InputJson gts = ReadJson(files.gt);
  const bool has_info = fs::exists(files.gt_info);
  const InputJson infos = has_info ? ReadJson(files.gt_info) : InputJson::object();
  if (!cameras.is_object()) throw BadData(files.camera.string() + ": an object keyed by image id is expected");
  const auto where = [](const fs::path& f, const std::string& key) { return f.string() + ": image " + key; };
  for (const auto& [key, camera] : cameras.items()) {
    FrameTruth& frame = truth.frames.emplace_back();
    frame.scene_id = scene_id;
    frame.image_id = IdOf(key, files.camera.string());
    frame.K = Place{camera, where(files.camera, key)}.At("cam_K").Matrix();
    if (!gts.contains(key)) continue;
    std::optional<Place> info;
    if (has_info) {
      if (!infos.contains(key)) throw BadData(where(files.gt_info, key) + ": missing; scene_gt has it");
      info.emplace(Place{infos.at(key), where(files.gt_info, key)});
    }
    frame.instances = ReadInstances({gts.at(key), where(files.gt, key)}, info, truth.objects);
  }
}

GroundTruth ReadAll(const fs::path& dataset) {
  GroundTruth truth;
  if (!fs::is_directory(dataset)) {
    throw BadData(dataset.string() + ": no such folder; give the root of a data set");
  }
  truth.objects = ReadObjects(dataset / "models");
  const fs::path test = dataset / "test";
  if (!fs::is_directory(test)) throw BadData(test.string() + ": no such folder; scenes are expected in it");
  for (const auto& entry : fs::directory_iterator(test)) {
    const std::optional<int> id = ParseId(entry.path().filename().string());
    if (id && entry.is_directory()) ReadScene(entry.path(), *id, truth);
  }
  if (truth.frames.empty()) throw BadData(test.string() + ": no frames; the data set is empty");
  std::ranges::sort(truth.frames, {}, [](const FrameTruth& f) { return std::pair(f.scene_id, f.image_id); });
  const fs::path camera = dataset / "camera_cam1.json";
  if (fs::exists(camera)) {
    const InputJson json = ReadJson(camera);
    truth.image_width_px = static_cast<int>(Place{json, camera.string()}.At("width").Number());
  }
  return truth;
}

}  // namespace

Result<GroundTruth, std::string> ReadGroundTruth(const fs::path& dataset) {
  try {
    return ReadAll(dataset);
  } catch (const BadData& e) {
    return unexpected<std::string>(e.what());
  } catch (const fs::filesystem_error& e) {
    return unexpected<std::string>(
        fmt::format("{}: cannot be read ({}); check its permissions", e.path1().string(), e.code().message()));
  }
}

void KeepFrames(const std::set<std::pair<int, int>>& listed, GroundTruth& truth) {
  std::erase_if(truth.frames, [&](const FrameTruth& f) { return !listed.contains({f.scene_id, f.image_id}); });
}

}  // namespace wirepose::evaluation
