// What a person wants to see of a frame: the lines, and which of them belong to which object. Plain data, no DDS.
#ifndef WIREPOSE_PUBLISH_SCENE_REPORT_H_
#define WIREPOSE_PUBLISH_SCENE_REPORT_H_

#include <array>
#include <chrono>
#include <cstdint>

#include "base/fixed_vector.h"
#include "capacities.h"
#include "pipeline/recognizer.h"
#include "publish/fixed_text.h"

namespace wirepose {

// Points of all lines together; a full scene of 512 lines and 16 objects of 30 visible edges has 1,900.
inline constexpr std::size_t kMaxScenePoints = 2048;

struct ScenePoint {
  float x, y, z;  // m
};

// Points [first, first + count) of the report, two a line.
struct SceneLines {
  std::uint16_t first = 0, count = 0;
};

struct SceneObject {
  FixedText<64> label;  // name and score
  Pose T_camera_model;
  SceneLines wireframe;  // the edges that the camera sees, model frame
  SceneLines line_set;   // the image lines found on them, camera frame
};

// Camera: the raw left camera's optical frame.
struct SceneReport {
  std::chrono::nanoseconds stamp{0};
  FixedVector<SceneObject, kMaxDetections> objects;
  SceneLines lines;  // all 3D lines, camera frame
  FixedVector<ScenePoint, kMaxScenePoints> points;
  std::uint32_t dropped = 0;  // lines that found no room
};

// Gathers the scene of the recognizer's last frame, whose result is given. Objects come first: they keep their lines
// when there is no room for all. O(points).
void FillScene(const Recognizer& recognizer, const RecognitionResult& result, SceneReport& scene);

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_SCENE_REPORT_H_
