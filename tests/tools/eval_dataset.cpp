#include "eval_dataset.h"

#include <stdlib.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace wirepose::evaluation::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

double Uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Json Flat(const Matrix3d& R) {
  Json json = Json::array();
  for (int i = 0; i < 9; ++i) json.push_back(R(i / 3, i % 3));
  return json;
}

Json Flat(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::vector<Vector3d> Cuboid(const Vector3d& size) {
  std::vector<Vector3d> out;
  for (int i = 0; i < 8; ++i) {
    out.emplace_back(Vector3d(i & 1, (i >> 1) & 1, i >> 2).cwiseProduct(size) - size / 2);
  }
  return out;
}

std::vector<Vector3d> Lump(std::mt19937& random) {
  std::vector<Vector3d> out;
  for (int i = 0; i < 40; ++i) {
    out.emplace_back(Uniform(random, -60, 60), Uniform(random, -90, 90), Uniform(random, -40, 40));
  }
  return out;
}

std::vector<Vector3d> Cone() {
  std::vector<Vector3d> out{{20, -10, 80}};
  for (int i = 0; i < 32; ++i) {
    const double a = 2 * std::numbers::pi * i / 32;
    out.emplace_back(20 + 50 * std::cos(a), -10 + 50 * std::sin(a), 0);
  }
  return out;
}

std::string AsciiPly(const std::vector<Vector3d>& vertices) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n",
      vertices.size());
  for (const Vector3d& v : vertices) text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
  return text + "3 0 1 2\n";
}

// With a property before the coordinates, and doubles.
std::string BinaryPly(const std::vector<Vector3d>& vertices) {
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty uchar red\nproperty "
      "double x\n"
      "property double y\nproperty double z\nend_header\n",
      vertices.size());
  for (const Vector3d& v : vertices) {
    char bytes[25] = {7};
    std::memcpy(bytes + 1, v.data(), 24);
    text.append(bytes, 25);
  }
  return text;
}

double Diameter(const std::vector<Vector3d>& vertices) {
  double d = 0;
  for (const Vector3d& a : vertices) {
    for (const Vector3d& b : vertices) d = std::max(d, (a - b).norm());
  }
  return d;
}

Json Turn(int axis) {
  Json m = Json::array();
  for (int i = 0; i < 16; ++i) m.push_back(i % 5 != 0 ? 0 : (i == 15 || i / 5 == axis) ? 1 : -1);
  return m;
}

void WriteModels(const fs::path& models, std::mt19937& random) {
  const auto cuboid = Cuboid({160, 110, 60});
  const auto lump = Lump(random);
  const auto cone = Cone();
  WriteText(models / "obj_000001.ply", AsciiPly(cuboid));
  WriteText(models / "obj_000002.ply", BinaryPly(lump));
  WriteText(models / "obj_000005.ply", AsciiPly(cone));
  Json info;
  info["1"] = {{"diameter", Diameter(cuboid)}, {"symmetries_discrete", {Turn(0), Turn(1), Turn(2)}}};
  info["2"] = {{"diameter", Diameter(lump)}};
  info["5"] = {{"diameter", Diameter(cone)},
               {"symmetries_continuous", {{{"axis", {0, 0, 2}}, {"offset", {20, -10, 0}}}}}};
  WriteText(models / "models_info.json", info.dump(1));
}

void WriteScene(const fs::path& scene, bool with_info, std::mt19937& random) {
  Json camera, gt, info;
  for (int image = 0; image < 6; ++image) {
    const std::string key = std::to_string(image * 3);
    camera[key] = {{"cam_K", {500.0, 0, 320.5, 0, 505.0, 240.25, 0, 0, 1}}, {"depth_scale", 1.0}};
    gt[key] = Json::array();
    info[key] = Json::array();
    const int count = static_cast<int>(random() % 5);
    for (int i = 0; i < count; ++i) {
      const int ids[] = {1, 1, 2, 5};
      const Vector3d t{Uniform(random, -300, 300), Uniform(random, -200, 200), Uniform(random, 500, 1500)};
      gt[key].push_back(
          {{"obj_id", ids[random() % 4]}, {"cam_R_m2c", Flat(RandomRotation(random))}, {"cam_t_m2c", Flat(t)}});
      info[key].push_back({{"visib_fract", Uniform(random, 0.2, 1)}});
    }
  }
  WriteText(scene / "scene_camera_cam1.json", camera.dump());
  WriteText(scene / "scene_gt_cam1.json", gt.dump());
  if (with_info) WriteText(scene / "scene_gt_info_cam1.json", info.dump());
}

Vector3d RandomVector(std::mt19937& random, double range) {
  return {Uniform(random, -range, range), Uniform(random, -range, range), Uniform(random, -range, range)};
}

RigidMm Perturb(const RigidMm& T, std::mt19937& random, double shift_mm, double turn_rad) {
  return {ExpSo3(RandomVector(random, turn_rad)) * T.R, T.t_mm + RandomVector(random, shift_mm)};
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "wirepose_eval_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void WriteText(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

Matrix3d RandomRotation(std::mt19937& random) { return Orthonormalize(ExpSo3(RandomVector(random, 3))); }

void WriteRandomDataset(const fs::path& root, std::mt19937& random) {
  WriteModels(root / "models", random);
  for (int scene = 1; scene <= 3; ++scene) {
    WriteScene(root / fmt::format("test/{:06d}", scene), scene != 2, random);
  }
  WriteText(root / "camera_cam1.json", R"({"width": 752, "height": 480})");
}

std::vector<Estimate> RandomEstimates(const GroundTruth& truth, std::mt19937& random) {
  std::vector<Estimate> out;
  const auto add = [&](const FrameTruth& f, int id, const RigidMm& T) {
    Estimate& e = out.emplace_back();
    e.scene_id = f.scene_id;
    e.image_id = f.image_id;
    e.object_id = id;
    e.score = 0.25 * static_cast<double>(random() % 5);  // ties are common
    e.T_camera_model = T;
    e.time_s = random() % 8 == 0 ? -1 : Uniform(random, 0.001, 0.03);
  };
  for (const FrameTruth& frame : truth.frames) {
    for (const InstanceTruth& instance : frame.instances) {
      const auto& symmetries = truth.objects.at(instance.object_id).symmetries;
      const int copies = static_cast<int>(random() % 4);
      for (int i = 0; i < copies; ++i) {
        const RigidMm symmetric = instance.T_camera_model * symmetries[random() % symmetries.size()];
        const double spread = std::pow(10.0, Uniform(random, -2, 2));
        add(frame, instance.object_id, Perturb(symmetric, random, spread, spread / 100));
      }
    }
    if (random() % 3 == 0) add(frame, 1, {RandomRotation(random), RandomVector(random, 800)});
    if (random() % 6 == 0) add(frame, 77, {RandomRotation(random), RandomVector(random, 800)});
  }
  FrameTruth nowhere;
  nowhere.scene_id = 9;
  add(nowhere, 2, {});
  return out;
}

}  // namespace wirepose::evaluation::testing
