#include "stages/pose_score.h"

#include <algorithm>
#include <cmath>

#include "base/portable_math.h"

namespace wirepose {

PoseScorer::PoseScorer(const PoseScoreParams& params, const SceneEdges& scene, const PreparedModel& model)
    : params_(params),
      scene_(scene),
      model_(model),
      f_(static_cast<float>(scene.camera.f)),
      cx_(static_cast<float>(scene.camera.cx)),
      cy_(static_cast<float>(scene.camera.cy)),
      fb_(static_cast<float>(scene.camera.f * scene.camera.baseline)) {
  left_gain_ = Gain(scene.left);
  right_gain_ = Gain(scene.right);
}

PoseScorer::LogGain PoseScorer::Gain(const EdgeMap& map) const {
  const float background = std::clamp(map.background, 0.03F, 0.5F);
  return {params_.sample_weight * Log(params_.support_rate / background),
          params_.sample_weight * Log((1 - params_.support_rate) / (1 - background))};
}

namespace {

// R p + t, written out: Eigen's product is a call here, and there are a hundred thousand a frame.
inline Vector3 Moved(const Matrix3& R, const Vector3& t, const Vector3& p) {
  return {R(0, 0) * p.x() + R(0, 1) * p.y() + R(0, 2) * p.z() + t.x(),
          R(1, 0) * p.x() + R(1, 1) * p.y() + R(1, 2) * p.z() + t.y(),
          R(2, 0) * p.x() + R(2, 1) * p.y() + R(2, 2) * p.z() + t.z()};
}

}  // namespace

bool PoseScorer::Project(const PreparedEdge& edge, const Matrix3& R, const Vector3& t, Projected& out) const {
  const Vector3 a = Moved(R, t, edge.a);
  const Vector3 b = Moved(R, t, edge.b);
  if (a.z() < 0.05F || b.z() < 0.05F) return false;
  const float ia = 1 / a.z(), ib = 1 / b.z();
  out.a = {f_ * a.x() * ia + cx_, f_ * a.y() * ia + cy_};
  out.b = {f_ * b.x() * ib + cx_, f_ * b.y() * ib + cy_};
  out.disparity_a = fb_ * ia;
  out.disparity_b = fb_ * ib;
  return true;
}

bool PoseScorer::Score(const Matrix3& R, const Vector3& t, const EdgeBits& visible, PoseSupport& out) const {
  struct Sampled {
    Projected p;
    int n;
  };
  FixedVector<Sampled, kMaxModelEdges> sampled;
  Support left, right;
  int total = 0;
  for (std::size_t e = NextEdge(visible, 0); e < model_.edges.size(); e = NextEdge(visible, e + 1)) {
    Projected p;
    if (!Project(model_.edges[e], R, t, p)) continue;
    const int n = std::clamp(static_cast<int>((p.b - p.a).norm() / params_.sample_step_px), 1, 16);
    total += n;
    AddSupport(scene_.left, left_gain_, p.a, p.b, n, left);
    sampled.push_back({p, n});
    if (static_cast<int>(sampled.size()) >= params_.first_edges &&
        static_cast<float>(left.hits) < params_.min_first_support * static_cast<float>(left.inside)) {
      return false;
    }
  }
  // The right image is asked only when the left one speaks for the pose.
  if (left.sum <= 0 || static_cast<float>(left.inside) < params_.min_inside * static_cast<float>(total)) return false;
  for (const Sampled& s : sampled) {
    const Projected& p = s.p;
    AddSupport(scene_.right, right_gain_, {p.a.x() - p.disparity_a, p.a.y()}, {p.b.x() - p.disparity_b, p.b.y()}, s.n,
               right);
  }
  out = {left.sum + right.sum, left.Share(), scene_.camera.has_right_image ? right.Share() : left.Share(),
         static_cast<int>(sampled.size())};
  return true;
}

void PoseScorer::AddSupport(const EdgeMap& map, const LogGain& gain, const Vector2& a, const Vector2& b, int n,
                            Support& out) {
  const Vector2 d = b - a;
  const int direction = EdgeMap::Direction(d.x(), d.y());
  const float step = 1 / static_cast<float>(n);
  int inside = n, hits = 0;
  if (map.Contains(a.x(), a.y()) && map.Contains(b.x(), b.y())) {
    // Fixed point, rounded to the cell: no test and no conversion a sample.
    constexpr float kOne = 65536.0F / EdgeMap::kScale, kHalf = 32768;
    const auto dx = static_cast<int>(d.x() * step * kOne), dy = static_cast<int>(d.y() * step * kOne);
    int x = static_cast<int>(a.x() * kOne + kHalf) + dx / 2, y = static_cast<int>(a.y() * kOne + kHalf) + dy / 2;
    for (int k = 0; k < n; ++k, x += dx, y += dy) hits += map.HasEdgeAt(x >> 16, y >> 16, direction) ? 1 : 0;
  } else {
    inside = 0;
    for (int k = 0; k < n; ++k) {
      const Vector2 p = a + (static_cast<float>(k) + 0.5F) * step * d;
      if (!map.Contains(p.x(), p.y())) continue;
      ++inside;
      hits += map.HasEdge(p.x(), p.y(), direction) ? 1 : 0;
    }
  }
  out.inside += inside;
  out.hits += hits;
  out.sum += static_cast<float>(hits) * gain.hit + static_cast<float>(inside - hits) * gain.miss;
}

}  // namespace wirepose
