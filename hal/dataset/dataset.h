// A stereo data set on disk: BOP's layout with multi-camera names.
//
//   ROOT/calib.yaml
//   ROOT/test/SSSSSS/gray_cam1/IIIIII.png, gray_cam2/IIIIII.png     raw (distorted, unrectified)
//   left and right ROOT/test/SSSSSS/scene_camera_cam1.json, scene_gt_cam1.json,
//   scene_gt_info_cam1.json      all optional here
//
// One camera with depth: depth_dataset.h.
#ifndef WIREPOSE_HAL_DATASET_DATASET_H_
#define WIREPOSE_HAL_DATASET_DATASET_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "geometry/camera.h"
#include "hal/dataset/calibration_file.h"
#include "hal/dataset/png_image.h"

namespace wirepose::dataset {

// One object known to be in a frame.
struct TrueInstance {
  int obj_id = 0;
  Pose T_camera_model;     // raw left camera; metres
  double visib_fract = 1;  // BOP's visible fraction; 1 when the data set does not say
};

// One stereo pair, or one image with depth. The image files need not exist: a recording may have lost one.
struct FrameEntry {
  int scene_id = 0;
  int im_id = 0;
  std::filesystem::path left_path, right_path;  // with depth the left one is the image, and there is no right one
  std::filesystem::path depth_path;             // 16 bit, registered to the image; empty in a stereo data set
  double depth_unit_m = 0;                      // metres a unit of the depth image
  bool has_truth = false;        // scene_gt_cam1.json lists this frame; false: `gt` is empty and says nothing
  std::vector<TrueInstance> gt;  // in the file's order
};

struct Dataset {
  std::filesystem::path root;
  StereoCalibration calibration;                 // of a stereo data set
  std::optional<DepthCalibration> depth_camera;  // set: one camera with depth
  std::vector<FrameEntry> frames;                // by scene_id, then im_id; never empty
};

// Reads calibration, frame list and truth; no image. A scene's frames are those of
// scene_camera_cam1.json and of both image folders together, so that a lost image shows as a frame
// without it. Refuses data sets of one camera. Allocates; takes O(files). The error is one line: "file: place: what;
// remedy". Neither throws nor crashes on any input.
[[nodiscard]] Result<Dataset, std::string> ReadDataset(const std::filesystem::path& root,
                                                       const std::string& split = "test");

// ROOT/models/obj_00000N.ply.
[[nodiscard]] std::filesystem::path ModelPath(const std::filesystem::path& root, int obj_id);

}  // namespace wirepose::dataset

#endif  // WIREPOSE_HAL_DATASET_DATASET_H_
