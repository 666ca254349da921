// A cuboid as a line model, without a model file.
#ifndef WIREPOSE_TESTS_TOOLS_BOX_MODEL_H_
#define WIREPOSE_TESTS_TOOLS_BOX_MODEL_H_

#include <vector>

#include "model/model_view.h"

namespace wirepose::testing {

// Owns what its view shows; centred on the origin, vertex i has x from bit 0, y from bit 1, z from
// bit 2 of i. The view is valid while the object is.
class BoxModel {
 public:
  BoxModel(float x_m, float y_m, float z_m) {
    for (int i = 0; i < 8; ++i) {
      vertices_.push_back({((i & 1) != 0 ? 0.5F : -0.5F) * x_m, ((i & 2) != 0 ? 0.5F : -0.5F) * y_m,
                           ((i & 4) != 0 ? 0.5F : -0.5F) * z_m});
      for (int bit : {1, 2, 4}) {
        if ((i & bit) == 0) edges_.push_back({{Index(i), Index(i | bit)}, {0, 0}, 0, 1.5708F, 1});
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int p = 1 << axis, q = 1 << (axis + 1) % 3, r = 1 << (axis + 2) % 3;
      for (int side : {0, p}) {
        triangles_.push_back({{Index(side), Index(side | q), Index(side | q | r)}, 0});
        triangles_.push_back({{Index(side), Index(side | q | r), Index(side | r)}, 0});
      }
    }
    view_.id = 1;
    view_.name = "box";
    view_.diameter_m = Vector3(x_m, y_m, z_m).norm();
    view_.vertices = vertices_;
    view_.triangles = triangles_;
    view_.edges = edges_;
  }
  BoxModel(const BoxModel&) = delete;
  BoxModel& operator=(const BoxModel&) = delete;

  [[nodiscard]] const ModelView& view() const { return view_; }

 private:
  static std::uint16_t Index(int i) { return static_cast<std::uint16_t>(i); }

  std::vector<ModelVertex> vertices_;
  std::vector<ModelTriangle> triangles_;
  std::vector<ModelEdge> edges_;
  ModelView view_;
};

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_TOOLS_BOX_MODEL_H_
