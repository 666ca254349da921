#include "stages/surface_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace wirepose {
namespace {

constexpr double kMinDepthM = 0.05;

class Sampler {
 public:
  Sampler(const SurfaceFitParams& params, const RectifiedCamera& camera, const PreparedModel& model, const Pose& T,
          const EdgeSamples& edges, const FrontTriangles& front, SurfaceSamples& out)
      : params_(params),
        camera_(camera),
        model_(model),
        edges_(edges),
        front_(front),
        out_(out),
        R_(T.R.cast<float>()),
        t_(T.t.cast<float>()),
        eye_(-(R_.transpose() * t_)) {}

  void Run() {
    float area = 0;
    for (const FrontTriangle& f : front_) {
      if (Corners(f)) area += 0.5F * std::abs(Cross(corner_[1] - corner_[0], corner_[2] - corner_[0]));
    }
    // Whole cells of the map, so that no two samples read the same one.
    const float step = std::max(params_.step_px, std::sqrt(area / static_cast<float>(kMaxSurfaceSamples)));
    step_ = DisparityMap::kScale * static_cast<int>(std::ceil(step / DisparityMap::kScale));
    for (std::size_t face = 0; face < model_.view.faces.size(); ++face) {
      if (IsTowards(model_.view.faces[face], eye_)) SampleFace(static_cast<std::uint16_t>(face));
    }
  }

 private:
  static float Cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

  // Projects a triangle; false when it comes too near.
  bool Corners(const FrontTriangle& f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3 p = R_ * model_.view.VertexPosition(model_.view.triangles[f.triangle].vertex[k]) + t_;
      if (!(p.z() > static_cast<float>(kMinDepthM))) return false;
      corner_[k] = static_cast<float>(camera_.f) / p.z() * p.head<2>() +
                   Vector2(static_cast<float>(camera_.cx), static_cast<float>(camera_.cy));
    }
    return true;
  }

  void SampleFace(std::uint16_t face) {
    for (const FrontTriangle& f : front_) {
      if (model_.view.triangles[f.triangle].face == face && Corners(f)) SampleTriangle(face, f);
    }
  }

  void SampleTriangle(std::uint16_t face, const FrontTriangle& f) {
    const auto first = [this](float low) {
      return std::max(0, static_cast<int>(std::ceil(low)) + step_ - 1) / step_ * step_;
    };
    const auto cut = [](float high, int size) {
      return std::min(high, static_cast<float>(size - DisparityMap::kScale));
    };
    const float high_x = cut(f.high.x(), camera_.width), high_y = cut(f.high.y(), camera_.height);
    if (!(f.low.x() < high_x && f.low.y() < high_y)) return;
    for (int y = first(f.low.y()); static_cast<float>(y) <= high_y; y += step_) {
      for (int x = first(f.low.x()); static_cast<float>(x) <= high_x; x += step_) {
        const Vector2 p(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
        if (Covers(p) && IsSeen(face, p) && !IsNearEdge(p) && !out_.try_push_back({p, face})) return;
      }
    }
  }

  // The border belongs to one of the triangles that share it: samples lie on whole cells, so doubles do no harm.
  [[nodiscard]] bool Covers(const Vector2& p) const {
    const float a = Cross(corner_[1] - corner_[0], p - corner_[0]), b = Cross(corner_[2] - corner_[1], p - corner_[1]),
                c = Cross(corner_[0] - corner_[2], p - corner_[2]);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
  }

  // Steep enough, and not behind another part of the model.
  [[nodiscard]] bool IsSeen(std::uint16_t face, const Vector2& p) const {
    const ModelFace& plane = model_.view.faces[face];
    const Vector3 normal(plane.normal[0], plane.normal[1], plane.normal[2]);
    const Vector3 ray =
        R_.transpose() * Vector3((p.x() - static_cast<float>(camera_.cx)) / static_cast<float>(camera_.f),
                                 (p.y() - static_cast<float>(camera_.cy)) / static_cast<float>(camera_.f), 1);
    const float along = normal.dot(ray);
    if (!(-along > params_.min_cosine * ray.norm())) return false;
    if (model_.convex) return true;
    const Vector3 point = eye_ + (plane.offset_m - normal.dot(eye_)) / along * ray;
    return !IsHidden(front_, point - eye_, p, face);
  }

  [[nodiscard]] bool IsNearEdge(const Vector2& p) const {
    for (const EdgeSample& e : edges_) {
      const Vector2 d = p - e.left;
      const float half = 0.5F * e.weight_px;
      const float along = d.dot(e.tangent);
      const Vector2 off = d - std::clamp(along, -half, half) * e.tangent;
      if (off.squaredNorm() < params_.margin_px * params_.margin_px) return true;
    }
    return false;
  }

  const SurfaceFitParams& params_;
  const RectifiedCamera& camera_;
  const PreparedModel& model_;
  const EdgeSamples& edges_;
  const FrontTriangles& front_;
  SurfaceSamples& out_;
  Matrix3 R_;
  Vector3 t_, eye_;
  std::array<Vector2, 3> corner_;
  int step_ = DisparityMap::kScale;
};

// Calls `use(begin, end)` for the rows of each face.
template <typename Use>
void ForEachFace(const SurfaceRows& rows, const Use& use) {
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i + 1;
    while (end < rows.size() && rows[end].face == rows[i].face) ++end;
    use(i, end);
    i = end;
  }
}

double Squared(float v) { return static_cast<double>(v) * static_cast<double>(v); }

double RobustScale(const SurfaceFitParams& params, const SurfaceRows& rows) {
  std::array<float, kMaxSurfaceSamples> magnitude;
  const std::size_t n = rows.size();
  for (std::size_t i = 0; i < n; ++i) magnitude[i] = static_cast<float>(std::abs(rows[i].residual));
  const auto middle = magnitude.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(magnitude.begin(), middle, magnitude.begin() + static_cast<std::ptrdiff_t>(n));
  return std::max(static_cast<double>(params.sigma_floor_px), 1.4826 * static_cast<double>(*middle));
}

// Minimises sum w (r - J x - b)^2 / noise^2 + b^2 / face^2 over the bias b of the face.
void EliminateBias(const SurfaceFitParams& params, std::size_t begin, std::size_t end, SurfaceRows& rows) {
  Vector6d sum = Vector6d::Zero();
  double weight = 0;
  for (std::size_t i = begin; i < end; ++i) {
    sum += rows[i].weight * rows[i].J;
    weight += rows[i].weight;
  }
  const double noise = Squared(params.noise_px);
  const double face = Squared(params.face_px) + rows[begin].sigma * rows[begin].sigma;
  const Vector6d bias = sum / (weight + noise / face);
  for (std::size_t i = begin; i < end; ++i) rows[i].pull = rows[i].weight / noise * (rows[i].J - bias);
}

}  // namespace

void SampleSurface(const SurfaceFitParams& params, const RectifiedCamera& camera, const PreparedModel& model,
                   const Pose& T_camera_model, const EdgeSamples& edges, FrontTriangles& front, SurfaceSamples& out) {
  out.clear();
  FindFrontTriangles(camera, model.view, T_camera_model, front);
  Sampler(params, camera, model, T_camera_model, edges, front, out).Run();
}

void MeasureSurface(const SurfaceFitParams& params, const RectifiedCamera& camera, const PreparedModel& model,
                    const Pose& T_camera_model, const DisparityMap& map, const SurfaceSamples& samples,
                    SurfaceRows& out) {
  out.clear();
  const double fb = camera.f * camera.baseline;
  for (const SurfaceSample& sample : samples) {
    const double measured =
        static_cast<double>(map.At(static_cast<int>(sample.pixel.x()), static_cast<int>(sample.pixel.y())));
    if (measured <= 0) continue;
    const ModelFace& face = model.view.faces[sample.face];
    const Vector3d normal = T_camera_model.R * Vector3(face.normal[0], face.normal[1], face.normal[2]).cast<double>();
    const double offset = static_cast<double>(face.offset_m) + normal.dot(T_camera_model.t);  // n . x of its points
    const Vector3d ray((static_cast<double>(sample.pixel.x()) - camera.cx) / camera.f,
                       (static_cast<double>(sample.pixel.y()) - camera.cy) / camera.f, 1);
    const double z = offset / normal.dot(ray);
    if (!(z > kMinDepthM)) continue;
    SurfaceRow row;
    row.residual = measured - fb / z;
    const double limit =
        std::max(static_cast<double>(params.max_residual_px), static_cast<double>(params.max_residual_share) * fb / z);
    if (!(std::abs(row.residual) < limit)) continue;
    // z = n.x / n.r; a twist (w, v) moves n by w x n and n.x by n . (w x (x - t) + v).
    const double gain = -fb / (z * offset);
    row.J.head<3>() = gain * (z * ray - T_camera_model.t).cross(normal);
    row.J.tail<3>() = gain * normal;
    row.face = sample.face;
    row.sigma = std::sqrt(Squared(params.common_px) + Squared(params.common_share) * fb * fb / (z * z));
    out.push_back(row);
  }
  if (out.empty()) return;
  const double scale = 2 * RobustScale(params, out);
  for (SurfaceRow& row : out) {
    const double r = row.residual / scale;
    const double k = 1 / (1 + r * r);
    row.weight = k * k;
  }
  ForEachFace(out, [&](std::size_t begin, std::size_t end) { EliminateBias(params, begin, end, out); });
}

void AddSurface(const SurfaceRows& rows, double unit_variance, Matrix6d& H, Vector6d& g) {
  for (const SurfaceRow& row : rows) {
    const Vector6d pull = unit_variance * row.pull;
    H += pull * row.J.transpose();
    g += row.residual * pull;
  }
}

Matrix6d SpreadOfSurface(const SurfaceFitParams& params, const SurfaceRows& rows, double unit_variance) {
  Matrix6d spread = Matrix6d::Zero(), faces = Matrix6d::Zero();
  Vector6d common = Vector6d::Zero();
  double scatter = 0, total = 0;
  ForEachFace(rows, [&](std::size_t begin, std::size_t end) {
    Vector6d face = Vector6d::Zero();
    double weight = 0, mean = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Vector6d pull = unit_variance * rows[i].pull;
      spread += Squared(params.noise_px) * pull * pull.transpose();
      face += pull;
      common += rows[i].sigma * pull;
      weight += rows[i].weight;
      mean += rows[i].weight * rows[i].residual;
    }
    if (weight <= 0) return;
    faces += face * face.transpose();
    scatter += mean * mean / weight;
    total += weight;
  });
  const double extra = static_cast<double>(params.scatter_gain) * scatter / std::max(total, 1e-9);
  spread += (Squared(params.face_px) + extra) * faces;
  spread += common * common.transpose();
  return spread;
}

}  // namespace wirepose
