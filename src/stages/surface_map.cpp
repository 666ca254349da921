#include "stages/surface_map.h"

#include <algorithm>
#include <cmath>

namespace wirepose {
namespace {

// A vertex in cells, with its disparity; both are affine over a triangle's image.
struct CellCorner {
  float x = 0, y = 0, disparity = 0;
};

class Rasterizer {
 public:
  Rasterizer(const RectifiedCamera& camera, const PreparedModel& model, const Pose& T, SurfaceMap& out)
      : model_(model),
        out_(out),
        R_(T.R.cast<float>()),
        t_(T.t.cast<float>()),
        f_(static_cast<float>(camera.f)),
        cx_(static_cast<float>(camera.cx)),
        cy_(static_cast<float>(camera.cy)),
        fb_(static_cast<float>(camera.f * camera.baseline)) {
    out.width = (camera.width + SurfaceMap::kScale - 1) / SurfaceMap::kScale;
    out.height = (camera.height + SurfaceMap::kScale - 1) / SurfaceMap::kScale;
  }

  void Run() {
    const Vector3 eye = -(R_.transpose() * t_);
    FixedVector<std::uint16_t, kMaxModelTriangles> seen;
    float low_x = 1e9F, low_y = 1e9F, high_x = -1e9F, high_y = -1e9F;
    for (std::size_t i = 0; i < model_.view.triangles.size(); ++i) {
      const ModelFace& face = model_.view.faces[model_.view.triangles[i].face];
      if (!IsTowards(face, eye) || !Corners(i)) continue;
      seen.push_back(static_cast<std::uint16_t>(i));
      for (const CellCorner& c : corner_) {
        low_x = std::min(low_x, c.x), high_x = std::max(high_x, c.x);
        low_y = std::min(low_y, c.y), high_y = std::max(high_y, c.y);
      }
    }
    SetBox(low_x, low_y, high_x, high_y);
    for (const std::uint16_t i : seen) {
      if (Corners(i)) Draw();
    }
  }

 private:
  // False when the triangle comes too near.
  bool Corners(std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3 p = R_ * model_.view.VertexPosition(model_.view.triangles[i].vertex[k]) + t_;
      if (p.z() < 0.05F) return false;
      constexpr float kCells = 1.0F / SurfaceMap::kScale;
      const float inverse = 1 / p.z();
      corner_[k] = {(f_ * p.x() * inverse + cx_) * kCells, (f_ * p.y() * inverse + cy_) * kCells, fb_ * inverse};
    }
    return true;
  }

  // The box with two cells around it, cut to the image, and cleared.
  void SetBox(float low_x, float low_y, float high_x, float high_y) {
    const auto cut = [](float v, int end) { return static_cast<int>(std::clamp(v, 0.0F, static_cast<float>(end))); };
    out_.x0 = cut(low_x - 2, out_.width);
    out_.y0 = cut(low_y - 2, out_.height);
    out_.x1 = std::max(out_.x0, cut(high_x + 4, out_.width));
    out_.y1 = std::max(out_.y0, cut(high_y + 4, out_.height));
    for (int j = out_.y0; j < out_.y1; ++j) {
      float* row = out_.disparity.data() + j * SurfaceMap::kWidth;
      std::fill(row + out_.x0, row + out_.x1, 0.0F);
    }
  }

  // Row by row: where the row enters and leaves the triangle, and disparity as an affine function.
  void Draw() {
    const auto& [a, b, c] = corner_;
    const float det = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (std::abs(det) < 1e-3F) return;
    const float dx = ((b.disparity - a.disparity) * (c.y - a.y) - (c.disparity - a.disparity) * (b.y - a.y)) / det;
    const float dy = ((c.disparity - a.disparity) * (b.x - a.x) - (b.disparity - a.disparity) * (c.x - a.x)) / det;
    const float high = std::max({a.y, b.y, c.y});
    const float highest = std::max({a.disparity, b.disparity, c.disparity});
    for (int j = std::max(out_.y0, static_cast<int>(std::ceil(std::min({a.y, b.y, c.y})))); j < out_.y1; ++j) {
      const auto y = static_cast<float>(j);
      if (y > high) break;
      float enter = 1e9F, leave = -1e9F;
      Cross(a, b, y, enter, leave);
      Cross(b, c, y, enter, leave);
      Cross(c, a, y, enter, leave);
      const int from = std::max(out_.x0, static_cast<int>(std::ceil(std::max(enter, 0.0F))));
      float* row = out_.disparity.data() + j * SurfaceMap::kWidth;
      for (int i = from; i < out_.x1 && static_cast<float>(i) <= leave; ++i) {
        // Rounding must not carry a sliver's disparity beyond its corners.
        row[i] = std::max(row[i], std::min(highest, a.disparity + dx * (static_cast<float>(i) - a.x) + dy * (y - a.y)));
      }
    }
  }

  static void Cross(const CellCorner& p, const CellCorner& q, float y, float& enter, float& leave) {
    if ((p.y < y && q.y < y) || (p.y > y && q.y > y)) return;
    const float height = q.y - p.y;
    const float x = height != 0 ? p.x + (y - p.y) / height * (q.x - p.x) : p.x;
    enter = std::min({enter, x, height != 0 ? x : q.x});
    leave = std::max({leave, x, height != 0 ? x : q.x});
  }

  const PreparedModel& model_;
  SurfaceMap& out_;
  Matrix3 R_;
  Vector3 t_;
  float f_, cx_, cy_, fb_;
  std::array<CellCorner, 3> corner_;
};

}  // namespace

void RenderSurface(const RectifiedCamera& camera, const PreparedModel& model, const Pose& T_camera_model,
                   SurfaceMap& out) {
  Rasterizer(camera, model, T_camera_model, out).Run();
}

}  // namespace wirepose
