// Models, random views of them, and what an observer with perfect eyes would extract from such a
// view.
#ifndef WIREPOSE_TESTS_STAGES_MODEL_TEST_SUPPORT_H_
#define WIREPOSE_TESTS_STAGES_MODEL_TEST_SUPPORT_H_

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <vector>

#include "model/prepared_model.h"
#include "stage_test_support.h"
#include "tests/mesh/test_meshes.h"
#include "tests/tools/model_test_options.h"
#include "tools/model_compiler/model_compiler.h"

namespace wirepose::testing {

struct TestModel {
  tools::CompiledModel file;
  std::unique_ptr<PreparedModel> prepared;
  [[nodiscard]] const PreparedModel& operator*() const { return *prepared; }
  [[nodiscard]] const PreparedModel* operator->() const { return prepared.get(); }
};

inline TestModel Prepare(tools::CompiledModel file) {
  TestModel model{std::move(file), std::make_unique<PreparedModel>()};
  PrepareModel(model.file.View(), *model.prepared);
  return model;
}

// One of the project's own meshes: parcel_box, book, juice_dispenser, refrigerator.
inline TestModel Load(const std::string& name) {
  auto file = tools::CompileModel(std::filesystem::path(WIREPOSE_MODELS) / (name + ".ply"), {});
  if (!file) throw std::runtime_error(file.error());
  return Prepare(std::move(*file));
}

inline TestModel Compile(const mesh::Mesh& mesh) {
  auto file = tools::CompileModel(mesh, TestOptions());
  if (!file) throw std::runtime_error(file.error());
  return Prepare(std::move(*file));
}

// The object near the middle of the image, its diameter `size_px` long, turned anyhow.
inline Pose AnyView(Random& random, const PreparedModel& model, const RectifiedCamera& camera, double size_px) {
  const double z = camera.f * static_cast<double>(model.view.diameter_m) / size_px;
  Pose T;
  T.R = AnyRotation(random);
  T.t = z * Vector3d(random.Uniform(-0.1, 0.1), random.Uniform(-0.08, 0.08), 1) - T.R * model.centre.cast<double>();
  return T;
}

// Largest distance of a box corner from where it should be, modulo the model's symmetries, m.
inline double CornerError(const PreparedModel& model, const Pose& estimate, const Pose& truth) {
  double best = 1e9;
  for (const Pose& symmetry : model.symmetries) {
    double worst = 0;
    for (const Vector3& corner : model.corners) {
      const Vector3d c = corner.cast<double>();
      worst = std::max(worst, (estimate * c - truth * (symmetry * c)).norm());
    }
    best = std::min(best, worst);
  }
  return best;
}

// Does a triangle that is not of face `a` or `b` hide `point` (model frame) from `eye`? Every
// triangle is tried, in double precision. `margin` widens the triangles (negative: shrinks) and the
// range of depths that hide, so that undecided cases can be told apart.
inline bool HiddenByBruteForce(const ModelView& model, const Vector3d& eye, const Vector3d& point, int a, int b,
                               double margin) {
  const Vector3d ray = point - eye;
  for (const ModelTriangle& t : model.triangles) {
    if (t.face == a || t.face == b) continue;
    Matrix3d M;
    const Vector3d p0 = model.VertexPosition(t.vertex[0]).cast<double>();
    M << model.VertexPosition(t.vertex[1]).cast<double>() - p0, model.VertexPosition(t.vertex[2]).cast<double>() - p0,
        -ray;
    if (std::abs(M.determinant()) < 1e-15) continue;
    const Vector3d uvt = M.inverse() * (eye - p0);
    if (uvt.x() > -margin && uvt.y() > -margin && uvt.x() + uvt.y() < 1 + margin && uvt.z() > 0 &&
        uvt.z() < 0.997 + 0.3 * margin) {
      return true;
    }
  }
  return false;
}

inline bool TurnsToEye(const ModelView& model, int face, const Vector3d& eye) {
  if (face == kNoFace) return false;
  const ModelFace& f = model.faces[static_cast<std::size_t>(face)];
  return Vector3(f.normal[0], f.normal[1], f.normal[2]).cast<double>().dot(eye) > static_cast<double>(f.offset_m);
}

// Is the point at share `s` of edge `e` seen?
inline bool SeesEdgePoint(const PreparedModel& model, std::size_t e, double s, const Vector3d& eye, double margin = 0) {
  const ModelEdge& edge = model.view.edges[e];
  if (!TurnsToEye(model.view, edge.face[0], eye) && !TurnsToEye(model.view, edge.face[1], eye)) return false;
  const Vector3d a = model.edges[e].a.cast<double>(), b = model.edges[e].b.cast<double>();
  return !HiddenByBruteForce(model.view, eye, a + s * (b - a), edge.face[0], edge.face[1], margin);
}

// The longest part of an edge that is seen, as shares of its length; nothing when it is hidden.
inline std::optional<std::pair<double, double>> VisiblePart(const PreparedModel& model, std::size_t e,
                                                            const Vector3d& eye) {
  constexpr int kSteps = 48;
  int best_begin = 0, best_end = 0, begin = 0;
  for (int k = 0; k <= kSteps; ++k) {
    if (k < kSteps && SeesEdgePoint(model, e, (k + 0.5) / kSteps, eye)) continue;
    if (k - begin > best_end - best_begin) {
      best_begin = begin;
      best_end = k;
    }
    begin = k + 1;
  }
  if (best_begin == best_end) return std::nullopt;
  return std::pair(1.0 * best_begin / kSteps, 1.0 * best_end / kSteps);
}

// A frame as the feature stages would describe it, made from the model itself.
struct IdealScene {
  RectifiedCamera camera = TestCamera();
  Lines3 lines;
  std::vector<int> edge_of_line;  // model edge that each line was made from; -1: clutter
  EdgeImage left_edges, right_edges;
  EdgeMap left, right;
};

struct IdealOptions {
  double min_cover = 0.75;  // share of the visible part of an edge that its segment shows
  double disparity_sigma_px = 0.1;
  double pixel_sigma_px = 0.15;
  int clutter = 15;  // further lines at random
};

inline void PaintRidge(EdgeImage& edges, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = (b - a).normalized();
  for (double s = 0; s < (b - a).norm(); s += 0.7) {
    const Eigen::Vector2d p = a + s * d;
    if (p.x() < 3 || p.y() < 3 || p.x() >= edges.width - 4 || p.y() >= edges.height - 4 ||
        edges.ridge_count >= kMaxRidgePixels)
      continue;
    const std::size_t i = EdgeImage::Index(static_cast<int>(p.x() + 0.5), static_cast<int>(p.y() + 0.5));
    edges.gx[i] = static_cast<std::int16_t>(-1000 * d.y());
    edges.gy[i] = static_cast<std::int16_t>(1000 * d.x());
    edges.ridge_pixels[edges.ridge_count++] = static_cast<std::uint32_t>(i);
  }
}

class IdealSceneMaker {
 public:
  IdealSceneMaker(Random& random, const IdealOptions& options) : random_(random), options_(options) {
    for (EdgeImage* edges : {&scene_->left_edges, &scene_->right_edges}) {
      edges->width = scene_->camera.width;
      edges->height = scene_->camera.height;
    }
  }

  void AddObject(const PreparedModel& model, const Pose& T) {
    const Vector3d eye = T.Inverse().t;
    for (std::size_t e = 0; e < model.edges.size(); ++e) {
      const auto part = VisiblePart(model, e, eye);
      if (!part) continue;
      const Vector3d a = T * model.edges[e].a.cast<double>(), b = T * model.edges[e].b.cast<double>();
      Add(a + part->first * (b - a), a + part->second * (b - a), static_cast<int>(e));
    }
  }

  std::unique_ptr<IdealScene> Finish() {
    for (int i = 0; i < options_.clutter; ++i) {
      const double z = random_.Uniform(0.5, 2);
      const Vector3d a = z * Vector3d(random_.Uniform(-0.5, 0.5), random_.Uniform(-0.4, 0.4), 1);
      Add(a, a + random_.Uniform(0.05, 0.4) * AnyDirection(random_), -1);
    }
    std::sort(found_.begin(), found_.end(),
              [](const auto& p, const auto& q) { return p.first.segment.Length() > q.first.segment.Length(); });
    for (auto& [line, edge] : found_) {
      line.id = static_cast<std::uint16_t>(scene_->lines.size());
      scene_->lines.push_back(line);
      scene_->edge_of_line.push_back(edge);
    }
    BuildEdgeMap(scene_->left_edges, scene_->left);
    BuildEdgeMap(scene_->right_edges, scene_->right);
    return std::move(scene_);
  }

 private:
  // The 3D piece a-b: its ridges in both images, and as a line that shows part of it.
  void Add(const Vector3d& a, const Vector3d& b, int edge) {
    if (a.z() < 0.1 || b.z() < 0.1) return;
    const RectifiedCamera& camera = scene_->camera;
    const Vector3d pa = camera.Project(a), pb = camera.Project(b);
    const double length = (pb - pa).head<2>().norm();
    if (length < 16) return;
    for (const Vector3d& p : {pa, pb}) {
      if (p.x() < 5 || p.y() < 5 || p.x() > camera.width - 6 || p.y() > camera.height - 6) return;
    }
    PaintRidge(scene_->left_edges, pa.head<2>(), pb.head<2>());
    PaintRidge(scene_->right_edges, {pa.x() - pa.z(), pa.y()}, {pb.x() - pb.z(), pb.y()});
    const double cover = random_.Uniform(options_.min_cover, 1), begin = random_.Uniform(0, 1 - cover);
    Vector3d qa = pa + begin * (pb - pa), qb = pa + (begin + cover) * (pb - pa);
    if (random_.Chance(0.5)) std::swap(qa, qb);
    Line3 line;
    const auto noisy = [&](const Vector3d& q) -> Vector2 {
      return Vector2(static_cast<float>(q.x() + options_.pixel_sigma_px * Gaussian(random_)),
                     static_cast<float>(q.y() + options_.pixel_sigma_px * Gaussian(random_)));
    };
    line.segment.a = noisy(qa);
    line.segment.b = noisy(qb);
    line.segment.contrast = 10;
    line.segment.sigma_offset_px = 0.1F;
    line.segment.sigma_angle_rad = static_cast<float>(0.3 / length);
    const double slope = std::abs(pb.y() - pa.y()) / length;
    // As with real stereo: lines along the rows have less certain depth, and often none.
    const double sigma = options_.disparity_sigma_px * (slope < 0.21 ? 4 : 1);
    line.has_depth = random_.Chance(slope < 0.21 ? 0.6 : 0.95);
    if (line.has_depth) {
      line.disparity_a_px = static_cast<float>(qa.z() + sigma * Gaussian(random_));
      line.disparity_b_px = static_cast<float>(qb.z() + sigma * Gaussian(random_));
      line.var_a = line.var_b = static_cast<float>(sigma * sigma + 0.01);
      const auto place = [&](const Vector2& p, float d) -> Vector3 {
        return camera.Triangulate(static_cast<double>(p.x()), static_cast<double>(p.y()), static_cast<double>(d))
            .cast<float>();
      };
      line.a = place(line.segment.a, line.disparity_a_px);
      line.b = place(line.segment.b, line.disparity_b_px);
    }
    found_.emplace_back(line, edge);
  }

  Random& random_;
  IdealOptions options_;
  std::unique_ptr<IdealScene> scene_ = std::make_unique<IdealScene>();
  std::vector<std::pair<Line3, int>> found_;
};

inline std::unique_ptr<IdealScene> MakeScene(Random& random, const PreparedModel& model, const Pose& T,
                                             const IdealOptions& options = {}) {
  IdealSceneMaker maker(random, options);
  maker.AddObject(model, T);
  return maker.Finish();
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_STAGES_MODEL_TEST_SUPPORT_H_
