#include "stages/verification.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "stages/edge_evidence.h"

namespace wirepose {
namespace {

constexpr int kPatchX = 3, kPatchY = 2;  // half sizes of a compared patch
constexpr int kPatchPixels = (2 * kPatchX + 1) * (2 * kPatchY + 1);

// Disparity of a plane: affine in the image, d = a u + b v + c.
struct PlaneDisparity {
  float a = 0, b = 0, c = 0;
  [[nodiscard]] float At(float u, float v) const { return a * u + b * v + c; }
};

PlaneDisparity DisparityOfFace(const RectifiedCamera& camera, const ModelFace& face, const Pose& T) {
  const Vector3d normal = T.R * Vector3d(static_cast<double>(face.normal[0]), static_cast<double>(face.normal[1]),
                                         static_cast<double>(face.normal[2]));
  const double h = static_cast<double>(face.offset_m) + normal.dot(T.t);  // normal . x = h in the camera frame
  const double s = camera.baseline / h;
  return {static_cast<float>(s * normal.x()), static_cast<float>(s * normal.y()),
          static_cast<float>(s * (camera.f * normal.z() - normal.x() * camera.cx - normal.y() * camera.cy))};
}

// Mean absolute difference between the left patch at (u, v) and the right one where the plane, shifted by `shift` px of
// disparity, predicts it; negative when the patch leaves an image.
float PatchCost(const VerifyInput& in, const PlaneDisparity& plane, int u, int v, float shift) {
  const float d0 = plane.At(static_cast<float>(u), static_cast<float>(v)) + shift;
  const float spread = std::abs(plane.a) * kPatchX + std::abs(plane.b) * kPatchY + 1;
  const float right = static_cast<float>(u) - d0;
  if (u < kPatchX || v < kPatchY || u + kPatchX >= in.camera.width || v + kPatchY >= in.camera.height) return -1;
  if (right - kPatchX - spread < 0 || right + kPatchX + spread >= static_cast<float>(in.camera.width - 1)) return -1;
  int sum = 0;
  for (int dy = -kPatchY; dy <= kPatchY; ++dy) {
    const std::uint8_t* left_row = in.left.data() + (v + dy) * kMaxImageWidth + u;
    const std::uint8_t* right_row = in.right.data() + (v + dy) * kMaxImageWidth;
    float x = right - plane.b * static_cast<float>(dy) + 0.5F - (1 - plane.a) * kPatchX;
    for (int dx = -kPatchX; dx <= kPatchX; ++dx, x += 1 - plane.a) {
      sum += std::abs(int{left_row[dx]} - int{right_row[static_cast<int>(x)]});
    }
  }
  return static_cast<float>(sum) / kPatchPixels;
}

// Costs of one surface at several shifts of disparity, summed over patches. Shifts are counted in units of what scale
// may be wrong by: a pixel, or 3 % of the disparity, by which real stereo rigs and object measures were seen to
// disagree.
struct ShiftProfile {
  static constexpr std::array<float, 9> kShifts = {-4.5F, -2.5F, -1, -0.5F, 0, 0.5F, 1, 2.5F, 4.5F};
  static constexpr std::size_t kNear = 2;  // first of the shifts that count as the plane itself
  static constexpr std::size_t kFar = 7;   // one past the last of them
  std::array<float, kShifts.size()> cost{};
  int patches = 0;

  static float Unit(float disparity) { return std::max(1.0F, 0.03F * disparity); }

  void Add(const VerifyInput& in, const PlaneDisparity& plane, int u, int v) {
    const float unit = Unit(plane.At(static_cast<float>(u), static_cast<float>(v)));
    std::array<float, kShifts.size()> here;
    for (std::size_t i = 0; i < kShifts.size(); ++i) {
      here[i] = PatchCost(in, plane, u, v, unit * kShifts[i]);
      if (here[i] < 0) return;
    }
    for (std::size_t i = 0; i < kShifts.size(); ++i) cost[i] += here[i];
    ++patches;
  }

  // Log-likelihood ratio per surface: how much better the plane explains the right image than other depths do. The
  // scale is set by the cost itself, which is what noise and sub-pixel shifts leave.
  [[nodiscard]] float LogRatio() const {
    if (patches < 4) return 0;
    float own = 1e9F, other = 1e9F;
    for (std::size_t i = 0; i < cost.size(); ++i) {
      float& lowest = i >= kNear && i < kFar ? own : other;
      lowest = std::min(lowest, cost[i]);
    }
    const auto n = static_cast<float>(patches);
    const float contrast = (other - own) / (own + 2 * n);
    return std::clamp(contrast, -0.5F, 0.5F) * std::sqrt(n);
  }
};

class EvidenceGatherer {
 public:
  EvidenceGatherer(const VerifyParams& params, const VerifyInput& input, const PreparedModel& model, const Pose& T,
                   VerifyScratch& scratch, Evidence& out)
      : params_(params), in_(input), model_(model), T_(T), scratch_(scratch), out_(out) {
    R_ = T.R.cast<float>();
    t_ = T.t.cast<float>();
    eye_ = -(R_.transpose() * t_);
  }

  void Run() {
    out_ = {};
    SampleVisibleEdges(params_.samples, in_.camera, model_, T_, scratch_.front, scratch_.samples);
    for (const EdgeSample& s : scratch_.samples) seen_[s.edge] = true;
    if (!model_.convex) FindFrontTriangles(in_.camera, model_.view, T_, scratch_.front);
    GatherEdgeEvidence(params_, in_, model_, eye_, scratch_.samples, out_);
    RenderSurface(in_.camera, model_, T_, scratch_.surface);
    GatherSurfaceEvidence(params_.surface, in_.disparity, scratch_.surface, out_.surface);
    for (std::size_t f = 0; f < model_.view.faces.size(); ++f) Face(f);
    Overrun();
  }

 private:
  [[nodiscard]] Vector3 Project(std::uint16_t vertex) const {
    const Vector3 p = R_ * model_.view.VertexPosition(vertex) + t_;
    const float z = std::max(p.z(), 0.05F);
    const auto f = static_cast<float>(in_.camera.f);
    return {f * p.x() / z + static_cast<float>(in_.camera.cx), f * p.y() / z + static_cast<float>(in_.camera.cy),
            p.z()};
  }

  // Patches on a grid over the face's triangles, where the object does not hide itself.
  void Face(std::size_t f) {
    const ModelFace& face = model_.view.faces[f];
    if (!IsTowards(face, eye_)) return;
    float area = 0;
    for (int i = 0; i < face.triangle_count; ++i) area += TriangleArea(face.first_triangle + i);
    if (area < params_.min_face_px2) return;
    const float grid = std::max(static_cast<float>(params_.face_grid_px),
                                std::sqrt(area / static_cast<float>(params_.max_face_patches)));
    const PlaneDisparity plane = DisparityOfFace(in_.camera, face, T_);
    ShiftProfile profile;
    for (int i = 0; i < face.triangle_count; ++i)
      AddTriangle(face.first_triangle + i, f, plane, static_cast<int>(grid), profile);
    out_.faces += profile.LogRatio();
  }

  [[nodiscard]] float TriangleArea(int i) const {
    const ModelTriangle& t = model_.view.triangles[static_cast<std::size_t>(i)];
    const Vector3 a = Project(t.vertex[0]), b = Project(t.vertex[1]), c = Project(t.vertex[2]);
    if (a.z() < 0.05F || b.z() < 0.05F || c.z() < 0.05F) return 0;
    return 0.5F * std::abs((b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()));
  }

  void AddTriangle(int i, std::size_t f, const PlaneDisparity& plane, int grid, ShiftProfile& profile) {
    const ModelTriangle& t = model_.view.triangles[static_cast<std::size_t>(i)];
    const Vector3 a = Project(t.vertex[0]), b = Project(t.vertex[1]), c = Project(t.vertex[2]);
    const float det = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (std::abs(det) < 1) return;
    const auto low = [&](float p, float q, float r) { return std::max(0, static_cast<int>(std::min({p, q, r}))); };
    const auto high = [&](float p, float q, float r, int end) {
      return std::min(static_cast<float>(end - 1), std::max({p, q, r}));
    };
    const int x0 = (low(a.x(), b.x(), c.x()) / grid + 1) * grid, y0 = (low(a.y(), b.y(), c.y()) / grid + 1) * grid;
    const int x1 = static_cast<int>(high(a.x(), b.x(), c.x(), in_.camera.width));
    const int y1 = static_cast<int>(high(a.y(), b.y(), c.y(), in_.camera.height));
    for (int y = y0; y <= y1; y += grid) {
      for (int x = x0; x <= x1; x += grid) {
        const float px = static_cast<float>(x) - a.x(), py = static_cast<float>(y) - a.y();
        const float s = (px * (c.y() - a.y()) - py * (c.x() - a.x())) / det;
        const float r = (py * (b.x() - a.x()) - px * (b.y() - a.y())) / det;
        if (s < 0 || r < 0 || s + r > 1) continue;
        if (!model_.convex && Hides(x, y, plane, f)) continue;
        if (profile.patches < 2 * params_.max_face_patches) profile.Add(in_, plane, x, y);
      }
    }
  }

  // True when another face of the object hides the face's point at this pixel.
  [[nodiscard]] bool Hides(int x, int y, const PlaneDisparity& plane, std::size_t f) const {
    const float d = plane.At(static_cast<float>(x), static_cast<float>(y));
    if (d < 0.5F) return true;
    const Vector3 p = in_.camera.Triangulate(x, y, static_cast<double>(d)).cast<float>();
    const Vector3 point = R_.transpose() * (p - t_);
    const Vector2 image(static_cast<float>(x), static_cast<float>(y));
    const auto face = static_cast<std::uint16_t>(f);
    return IsHidden(model_.view, scratch_.front, eye_, point, image, face, face);
  }

  // Does the image edge go on where the model edge ends? Looked at 5, 8 and 11 px beyond both ends of long edges.
  void Overrun() {
    int ends = 0, overrun = 0;
    for (std::size_t e = 0; e < model_.edges.size(); ++e) {
      if (!seen_[e]) continue;
      const Vector3 a = Project(model_.view.edges[e].vertex[0]), b = Project(model_.view.edges[e].vertex[1]);
      const Vector2 d = (b - a).head<2>();
      const float length = d.norm();
      if (length < 25) continue;
      const Vector2 u = d / length;
      for (const float sign : {-1.0F, 1.0F}) {
        const Vector2 end = sign < 0 ? a.head<2>() : b.head<2>();
        int inside = 0, hits = 0;
        for (const float beyond : {5.0F, 8.0F, 11.0F}) {
          const Vector2 p = end + sign * beyond * u;
          if (!in_.left_edges.Contains(p.x(), p.y())) continue;
          ++inside;
          if (in_.left_edges.HasEdge(p.x(), p.y(), EdgeMap::Direction(u.x(), u.y()))) ++hits;
        }
        if (inside < 3) continue;
        ++ends;
        if (hits >= 2) ++overrun;
      }
    }
    out_.overrun = static_cast<float>(overrun) / static_cast<float>(std::max(ends, 4));
  }

  const VerifyParams& params_;
  const VerifyInput& in_;
  const PreparedModel& model_;
  const Pose& T_;
  VerifyScratch& scratch_;
  Evidence& out_;
  Matrix3 R_;
  Vector3 t_, eye_;
  std::array<bool, kMaxModelEdges> seen_{};  // edges with samples
};

}  // namespace

void GatherEvidence(const VerifyParams& params, const VerifyInput& input, const PreparedModel& model,
                    const Pose& T_camera_model, VerifyScratch& scratch, Evidence& out) {
  EvidenceGatherer(params, input, model, T_camera_model, scratch, out).Run();
}

}  // namespace wirepose
