// What a perfect observer would know about one image.
#ifndef WIREPOSE_SIM_TRUTH_H_
#define WIREPOSE_SIM_TRUTH_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/dataset/dataset_writer.h"
#include "sim/renderer.h"

namespace wirepose::sim {

// One target object; pixel counts as bop_toolkit defines them.
struct ObjectTruth {
  int instance = 0;  // index into Scene::instances
  int obj_id = 0;
  std::string name;
  Pose T_camera_object;                         // metres
  int px_count_all = 0;                         // whole silhouette without occluders; the part outside of the image is
                                                // counted in an undistorted image that is wide enough
  int px_count_in_image = 0;                    // of these inside the image
  int px_count_visib = 0;                       // of these seen
  double visib_fract = 0;                       // px_count_visib / px_count_all
  std::array<int, 4> bbox_visib{-1, -1, 0, 0};  // x, y, width, height of what is seen
  std::vector<dataset::EdgePart> left_edges, right_edges;  // ShootStereo fills them in: see edge_truth.h
};

struct Truth {
  int width = 0, height = 0;
  std::vector<float> depth_m;          // z of the surface at each raw pixel's centre; 0 where nothing is
  std::vector<std::int16_t> instance;  // index into Scene::instances at each raw pixel's centre, or -1
  std::vector<ObjectTruth> objects;    // every instance with obj_id > 0, in their order in the scene
};

// Ray casts one ray a pixel, and one more for each pixel near a target. Exact: no noise, no blur.
[[nodiscard]] Truth FindTruth(const Renderer& renderer, const Camera& camera, int threads);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_TRUTH_H_
