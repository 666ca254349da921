// A data set of one camera with registered depth on disk: BOP's layout with single-camera names.
//
//   ROOT/test/SSSSSS/rgb/IIIIII.png or gray/IIIIII.png    8 bit, colour or grey
//   ROOT/test/SSSSSS/depth/IIIIII.png                     16 bit, registered to the image; 0 where nothing was measured
//   ROOT/test/SSSSSS/scene_camera.json                    cam_K and depth_scale (to mm) of every image
//   ROOT/test/SSSSSS/scene_gt.json, scene_gt_info.json    optional here
#ifndef WIREPOSE_HAL_DATASET_DEPTH_DATASET_H_
#define WIREPOSE_HAL_DATASET_DEPTH_DATASET_H_

#include <filesystem>
#include <string>

#include "base/result.h"
#include "hal/dataset/dataset.h"

namespace wirepose::dataset {

// True when ROOT has no calib.yaml and a scene of it has a scene_camera.json.
[[nodiscard]] bool IsDepthDataset(const std::filesystem::path& root, const std::string& split = "test");

// Reads camera, frame list and truth, and one image for its size. Frames are those of scene_camera.json; an image that
// is not there is listed all the same. The layout knows no lens distortion. All images must have one cam_K. Allocates;
// takes O(files). The error is one line: "file: place: what; remedy". Neither throws nor crashes on any input.
[[nodiscard]] Result<Dataset, std::string> ReadDepthDataset(const std::filesystem::path& root,
                                                            const std::string& split = "test");

}  // namespace wirepose::dataset

#endif  // WIREPOSE_HAL_DATASET_DEPTH_DATASET_H_
