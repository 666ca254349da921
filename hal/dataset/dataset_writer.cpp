#include "hal/dataset/dataset_writer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "hal/dataset/calibration_file.h"
#include "hal/dataset/json_file.h"
#include "hal/dataset/scene_files.h"

namespace wirepose::dataset {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json RowMajor(const Matrix3d& R) {
  ordered_json list = ordered_json::array();
  for (int i = 0; i < 9; ++i) list.push_back(R(i / 3, i % 3));
  return list;
}

ordered_json Millimetres(const Vector3d& t) { return {1000 * t.x(), 1000 * t.y(), 1000 * t.z()}; }

ordered_json SceneCamera(const CameraIntrinsics& c, const Pose& T_camera_world) {
  return {{"cam_K", {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}},
          {"depth_scale", kDepthScale},
          {"cam_D", {c.k1, c.k2, c.p1, c.p2, c.k3}},
          {"cam_R_w2c", RowMajor(T_camera_world.R)},
          {"cam_t_w2c", Millimetres(T_camera_world.t)}};
}

ordered_json SceneGt(const InstanceRecord& instance, const Pose& T_camera_left) {
  const Pose T = T_camera_left * instance.T_left_model;
  return {{"obj_id", instance.obj_id}, {"cam_R_m2c", RowMajor(T.R)}, {"cam_t_m2c", Millimetres(T.t)}};
}

ordered_json SceneGtInfo(const InstanceRecord& instance) {
  return {{"px_count_all", instance.px_count_all},
          {"px_count_visib", instance.px_count_visib},
          {"px_count_in_image", instance.px_count_in_image},
          {"px_count_valid", instance.px_count_visib},
          {"visib_fract", instance.visib_fract},
          {"bbox_visib", instance.bbox_visib}};
}

// [edge, from, to, x0, y0, x1, y1] for each part.
ordered_json SceneEdges(const std::vector<EdgePart>& parts) {
  ordered_json list = ordered_json::array();
  const auto rounded = [](double value) { return std::round(1e4 * value) / 1e4; };
  for (const EdgePart& part : parts) {
    ordered_json row = {part.edge, rounded(part.from), rounded(part.to)};
    for (const double pixel : part.pixels) row.push_back(rounded(pixel));
    list.push_back(row);
  }
  return list;
}

ordered_json CameraJson(const CameraIntrinsics& c, const StereoCalibration& calibration) {
  return {{"cx", c.cx},
          {"cy", c.cy},
          {"fx", c.fx},
          {"fy", c.fy},
          {"width", calibration.width},
          {"height", calibration.height},
          {"depth_scale", kDepthScale}};
}

Result<void, std::string> MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return unexpected(folder.string() + ": cannot be created: " + error.message() + "; check path and permissions");
  }
  return {};
}

// Does steps in order up to the first that fails.
template <typename... Steps>
Result<void, std::string> InOrder(Steps... steps) {
  Result<void, std::string> result;
  ((result = steps(), result.has_value()) && ...);
  return result;
}

}  // namespace

Result<DatasetWriter, std::string> DatasetWriter::Create(const fs::path& root, const StereoCalibration& calibration) {
  std::error_code error;
  if (fs::exists(root / "calib.yaml", error)) {
    return unexpected(root.string() + ": there is a data set already; choose another folder");
  }
  const Result<void, std::string> done =
      InOrder([&] { return MakeFolder(root / "models"); }, [&] { return MakeFolder(root / "test"); },
              [&] { return WriteCalibration(root / "calib.yaml", calibration); },
              [&] { return WriteJson(root / "camera_cam1.json", CameraJson(calibration.left, calibration)); },
              [&] { return WriteJson(root / "camera_cam2.json", CameraJson(calibration.right, calibration)); });
  if (!done) return unexpected(done.error());
  return DatasetWriter(root, calibration);
}

DatasetWriter DatasetWriter::Continue(const fs::path& root, const StereoCalibration& calibration) {
  return {root, calibration};
}

Result<void, std::string> DatasetWriter::AddFrame(int scene_id, const FrameRecord& record, ImageView left,
                                                  ImageView right, BasicImageView<const std::uint16_t> depth) {
  const fs::path scene = root_ / "test" / SixDigits(scene_id);
  const std::string file = SixDigits(record.im_id) + ".png";
  records_.push_back(record);
  return InOrder([&] { return MakeFolder(scene / "gray_cam1"); }, [&] { return MakeFolder(scene / "gray_cam2"); },
                 [&] { return WriteGrayPng(scene / "gray_cam1" / file, left); },
                 [&] { return WriteGrayPng(scene / "gray_cam2" / file, right); },
                 [&]() -> Result<void, std::string> {
                   if (depth.data == nullptr) return {};
                   const Result<void, std::string> made = MakeFolder(scene / "depth_cam1");
                   if (!made) return made;
                   return WriteDepthPng(scene / "depth_cam1" / file, depth);
                 });
}

Result<void, std::string> DatasetWriter::FinishScene(int scene_id) {
  ordered_json camera1, camera2, gt1, gt2, edges1, edges2, info;
  const Pose& T_right_left = calibration_.T_right_left;
  std::sort(records_.begin(), records_.end(), [](const auto& a, const auto& b) { return a.im_id < b.im_id; });
  for (const FrameRecord& record : records_) {
    const std::string key = std::to_string(record.im_id);
    camera1[key] = SceneCamera(calibration_.left, record.T_left_world);
    camera2[key] = SceneCamera(calibration_.right, T_right_left * record.T_left_world);
    gt1[key] = gt2[key] = edges1[key] = edges2[key] = info[key] = ordered_json::array();
    for (const InstanceRecord& instance : record.instances) {
      gt1[key].push_back(SceneGt(instance, Pose{}));
      gt2[key].push_back(SceneGt(instance, T_right_left));
      edges1[key].push_back(SceneEdges(instance.left_edges));
      edges2[key].push_back(SceneEdges(instance.right_edges));
      info[key].push_back(SceneGtInfo(instance));
    }
  }
  records_.clear();
  const fs::path scene = root_ / "test" / SixDigits(scene_id);
  return InOrder([&] { return WriteJson(scene / "scene_camera_cam1.json", camera1); },
                 [&] { return WriteJson(scene / "scene_camera_cam2.json", camera2); },
                 [&] { return WriteJson(scene / "scene_gt_cam1.json", gt1); },
                 [&] { return WriteJson(scene / "scene_gt_cam2.json", gt2); },
                 [&] { return WriteJson(scene / "scene_edges_cam1.json", edges1); },
                 [&] { return WriteJson(scene / "scene_edges_cam2.json", edges2); },
                 [&] { return WriteJson(scene / "scene_gt_info_cam1.json", info); });
}

}  // namespace wirepose::dataset
