// What a data set says is there: objects with their symmetries, frames with their instances, in
// BOP's units (mm).
#ifndef WIREPOSE_TOOLS_EVALUATION_GROUND_TRUTH_H_
#define WIREPOSE_TOOLS_EVALUATION_GROUND_TRUTH_H_

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "geometry/se3.h"

namespace wirepose::evaluation {

inline constexpr double kMmPerMetre = 1000;

// A rigid motion in BOP's units: p_target = R * p_source + t_mm, millimetres on both sides.
struct RigidMm {
  Matrix3d R = Matrix3d::Identity();
  Vector3d t_mm = Vector3d::Zero();

  [[nodiscard]] Vector3d operator*(const Vector3d& p_mm) const { return R * p_mm + t_mm; }
  // T_a_c = T_a_b * T_b_c.
  [[nodiscard]] RigidMm operator*(const RigidMm& other) const { return {R * other.R, R * other.t_mm + t_mm}; }
};

// One known object. `symmetries` map the object onto itself; the first one is the identity.
// Continuous symmetries are sampled in 64 steps of a turn, as bop_toolkit does; `continuous` tells
// that they were.
struct ObjectTruth {
  std::vector<Vector3d> vertices_mm;
  std::vector<RigidMm> symmetries;
  double diameter_mm = 0;
  bool continuous = false;
};

// One object in one frame, posed in the raw left camera.
struct InstanceTruth {
  int object_id = 0;
  RigidMm T_camera_model;
  double visible_fraction = 1;  // 1 where the data set does not say
};

struct FrameTruth {
  int scene_id = 0;
  int image_id = 0;
  Matrix3d K = Matrix3d::Identity();  // undistorted pinhole of the raw left camera, px
  std::vector<InstanceTruth> instances;
};

struct GroundTruth {
  std::map<int, ObjectTruth> objects;  // by BOP object id
  std::vector<FrameTruth> frames;      // by scene, then image
  int image_width_px = 640;
};

// Reads DATASET/models/ and DATASET/test/*/scene_*.json (the layout with two cameras or BOP's with
// one). No images. Error: "file: place: what is wrong; remedy", one line. May throw only
// std::bad_alloc.
Result<GroundTruth, std::string> ReadGroundTruth(const std::filesystem::path& dataset);

// Keeps the frames whose (scene, image) is listed: an evaluation that saw only some frames must be
// judged by them alone. O(frames * log listed).
void KeepFrames(const std::set<std::pair<int, int>>& listed, GroundTruth& truth);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_GROUND_TRUTH_H_
