// Writes data sets in the layout that dataset.h reads, with all that BOP tools ask for.
#ifndef WIREPOSE_HAL_DATASET_DATASET_WRITER_H_
#define WIREPOSE_HAL_DATASET_DATASET_WRITER_H_

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "geometry/camera.h"
#include "hal/dataset/png_image.h"

namespace wirepose::dataset {

// Depth images hold millimetres times 10: 0.1 mm steps up to 6.5535 m; 0 where nothing is seen or
// beyond.
inline constexpr double kDepthScale = 0.1;

// A part of a model edge that one eye sees.
struct EdgePart {
  int edge = 0;                    // index into the model's edges in models/model_edges.json
  double from = 0, to = 1;         // along the edge: 0 its first end, 1 its second
  std::array<double, 4> pixels{};  // x y of both ends in the raw image
};

// What BOP's scene_gt and scene_gt_info say about one object; the pixel counts as bop_toolkit
// defines them.
struct InstanceRecord {
  int obj_id = 0;
  Pose T_left_model;          // raw left camera; metres
  int px_count_all = 0;       // whole silhouette, without occluders, also what lies outside of the image
  int px_count_in_image = 0;  // of these inside the left image
  int px_count_visib = 0;     // of these seen
  double visib_fract = 0;     // px_count_visib / px_count_all
  std::array<int, 4> bbox_visib{-1, -1, 0, 0};  // x, y, width, height of what is seen, px
  std::vector<EdgePart> left_edges, right_edges;
};

struct FrameRecord {
  int im_id = 0;
  Pose T_left_world;  // metres
  std::vector<InstanceRecord> instances;
};

// Writes one data set. Methods return the reason of failure in one line: "file: what; remedy". Not
// thread safe.
class DatasetWriter {
 public:
  // Creates ROOT, ROOT/models and ROOT/test; writes calib.yaml and camera_cam{1,2}.json. Refuses a
  // root that already has a calib.yaml: data sets are never mixed.
  [[nodiscard]] static Result<DatasetWriter, std::string> Create(const std::filesystem::path& root,
                                                                 const StereoCalibration& calibration);

  // Goes on with a data set that Create made: further scenes, or a scene anew.
  [[nodiscard]] static DatasetWriter Continue(const std::filesystem::path& root, const StereoCalibration& calibration);

  // Writes the images of one frame and keeps its record for FinishScene. `depth` may be empty (data
  // == nullptr).
  [[nodiscard]] Result<void, std::string> AddFrame(int scene_id, const FrameRecord& record, ImageView left,
                                                   ImageView right, BasicImageView<const std::uint16_t> depth);

  // Writes scene_camera, scene_gt, scene_edges and scene_gt_info of the frames added since the last call, by
  // their im_id. scene_gt_info comes last: where it is, the scene is complete.
  [[nodiscard]] Result<void, std::string> FinishScene(int scene_id);

  [[nodiscard]] const std::filesystem::path& root() const { return root_; }

 private:
  DatasetWriter(std::filesystem::path root, const StereoCalibration& calibration)
      : root_(std::move(root)), calibration_(calibration) {}

  std::filesystem::path root_;
  StereoCalibration calibration_;
  std::vector<FrameRecord> records_;  // of the scene being written
};

}  // namespace wirepose::dataset

#endif  // WIREPOSE_HAL_DATASET_DATASET_WRITER_H_
