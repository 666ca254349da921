#include "stages/hypotheses.h"

#include <algorithm>
#include <cmath>

#include "base/work_budget.h"

namespace wirepose {
namespace {

// Unit normal of the plane through the camera centre and an image segment.
Vector3 PlaneNormal(const RectifiedCamera& camera, const Segment2& s) {
  const auto ray = [&](const Vector2& p) {
    return Vector3((p.x() - static_cast<float>(camera.cx)) / static_cast<float>(camera.f),
                   (p.y() - static_cast<float>(camera.cy)) / static_cast<float>(camera.f), 1);
  };
  return ray(s.a).cross(ray(s.b)).normalized();
}

// The rotation that carries the orthonormal frame of (m1, m2) into that of (d1, d2); both pairs at the same angle.
Matrix3 RotationOf(const Vector3& m1, const Vector3& m2, const Vector3& d1, const Vector3& d2) {
  Matrix3 M, D;
  M.col(0) = m1;
  M.col(1) = (m2 - m1.dot(m2) * m1).normalized();
  M.col(2) = M.col(0).cross(M.col(1));
  D.col(0) = d1;
  D.col(1) = (d2 - d1.dot(d2) * d1).normalized();
  D.col(2) = D.col(0).cross(D.col(1));
  return D * M.transpose();
}

class HypothesisMaker {
 public:
  HypothesisMaker(const HypothesisParams& params, const SceneEdges& scene, const PreparedModel& model,
                  const Lines3& lines, Hypotheses& out)
      : params_(params),
        scene_(scene),
        model_(model),
        lines_(lines),
        out_(out),
        scorer_(params.score, scene, model),
        f_(static_cast<float>(scene.camera.f)),
        cx_(static_cast<float>(scene.camera.cx)),
        cy_(static_cast<float>(scene.camera.cy)),
        budget_(params.max_steps) {}

  [[nodiscard]] bool budget_hit() const { return budget_.hit(); }

  void Make(const CorrespondingPair& match, const ImageLinePair& pair) {
    base_ = &lines_[pair.base];
    other_ = &lines_[pair.other];
    base_edge_ = &model_.edges[match.base_edge];
    other_edge_ = &model_.edges[match.other_edge];
    hypothesis_.base_line = pair.base;
    hypothesis_.other_line = pair.other;
    hypothesis_.base_edge = match.base_edge;
    hypothesis_.other_edge = match.other_edge;
    d1_ = base_->Direction();
    m1_ = match.base_flipped != 0 ? Vector3(-base_edge_->direction) : base_edge_->direction;
    const float c = m1_.dot(other_edge_->direction);
    if (std::abs(c) < 0.97F) {
      MakeFromAngle(c, pair, match);
    } else if (pair.metric) {
      MakeFromParallels();
    }
  }

 private:
  // In the frames (d1, e2, e3) of the image and (m1, m2, m3) of the model, whose second axis lies in the plane of base
  // and other direction, everything but the last angle is known: poses that do not fit cost no rotation.
  void MakeFromAngle(float c, const ImageLinePair& pair, const CorrespondingPair& match) {
    const Vector3 n = PlaneNormal(scene_.camera, other_->segment);
    const float nd = n.dot(d1_);
    const float k = std::sqrt(std::max(0.0F, 1 - nd * nd));
    const float s = std::sqrt(1 - c * c);
    // Seen along the base line's own plane the angle tells little about the direction: there the length must help.
    if (match.junction != 0 && k < 0.6F) MakeFromLength(c, pair, match);
    if (k < 0.05F) return;
    const float cosine = -c * nd / (s * k);
    if (std::abs(cosine) > 1.03F) return;
    const float clamped = std::clamp(cosine, -1.0F, 1.0F);
    const float sine = std::sqrt(1 - clamped * clamped);
    const Vector3 u = (n - nd * d1_) / k;
    const Vector3 v = d1_.cross(u);
    SetModelFrame((other_edge_->direction - c * m1_) / s);
    const Vector3 middle = 0.5F * (base_->a + base_->b);
    const float offset = n.dot(middle) + nd * other_a_.x() + k * clamped * other_a_.y();
    for (const float sign : {sine, -sine}) {
      const Vector3 e2 = clamped * u + sign * v;
      if (pair.metric && std::abs((c * d1_ + s * e2).dot(other_->Direction())) < MinCosine(pair)) continue;
      if (std::abs(nd) > 0.1F) {
        ScoreInFrame(middle, (k * sign * other_a_.z() - offset) / nd, e2);
      } else if (match.junction != 0) {
        ScoreInFrame(middle, AlongOfCorner(middle, pair.base_end), e2);
      }
    }
  }

  // The model's frame, with the base edge's middle as its origin and `m2` across the edge.
  void SetModelFrame(const Vector3& m2) {
    M_.col(0) = m1_;
    M_.col(1) = m2;
    M_.col(2) = m1_.cross(m2);
    model_middle_ = 0.5F * (base_edge_->a + base_edge_->b);
    other_a_ = M_.transpose() * (other_edge_->a - model_middle_);
    other_b_ = M_.transpose() * (other_edge_->b - model_middle_);
  }

  // Where the base edge's middle must lie along the base line, for its corner to be at the line's end `end`.
  [[nodiscard]] float AlongOfCorner(const Vector3& middle, LineEnd end) const {
    const float half = 0.5F * base_edge_->length_m;  // whichever way the edge runs, it reaches as far both ways
    return end == LineEnd::kA ? (base_->a - middle).dot(d1_) + half : (base_->b - middle).dot(d1_) - half;
  }

  // The model's frame put to (d1, e2, d1 x e2), its origin `along` the base line from its middle.
  void ScoreInFrame(const Vector3& middle, float along, const Vector3& e2) {
    const Vector3 origin = middle + along * d1_;
    const Vector3 half = 0.5F * base_edge_->length_m * d1_;
    if (!Covers(origin - half, origin + half, base_->segment)) return;
    Matrix3 D;
    D.col(0) = d1_;
    D.col(1) = e2;
    D.col(2) = d1_.cross(e2);
    if (!Covers(origin + D * other_a_, origin + D * other_b_, other_->segment)) return;
    hypothesis_.R = D * M_.transpose();
    hypothesis_.t = origin - hypothesis_.R * model_middle_;
    ScoreCovered();
  }

  // From a junction whose other segment shows its edge in full length: the far end lies on the ray of the segment's far
  // end at the edge's length from the corner, which has two solutions; that the angle comes out right proves them.
  void MakeFromLength(float c, const ImageLinePair& pair, const CorrespondingPair& match) {
    const Vector3 corner = pair.base_end == LineEnd::kA ? base_->a : base_->b;
    const Vector2 far = pair.other_end == LineEnd::kA ? other_->segment.b : other_->segment.a;
    const Vector3 ray = Vector3((far.x() - cx_) / f_, (far.y() - cy_) / f_, 1).normalized();
    const float along = ray.dot(corner);
    const float length = other_edge_->length_m;
    const float room = length * length - (corner.squaredNorm() - along * along);
    if (room < -0.1F * length * length) return;
    const float root = std::sqrt(std::max(0.0F, room));
    // The model edge leaves the corner forwards or backwards.
    const PreparedEdge& base = *base_edge_;
    const bool corner_is_a = (pair.base_end == LineEnd::kA) != (match.base_flipped != 0);
    const Vector3 model_corner = corner_is_a ? base.a : base.b;
    const bool forwards = (other_edge_->a - model_corner).squaredNorm() < (other_edge_->b - model_corner).squaredNorm();
    const Vector3 m2 = forwards ? other_edge_->direction : Vector3(-other_edge_->direction);
    const float expected = forwards ? c : -c;
    for (float sign : {1.0F, -1.0F}) {
      const Vector3 d2 = ((along + sign * root) * ray - corner).normalized();
      if (std::abs(d2.dot(d1_) - expected) > params_.length_angle_tolerance) continue;
      hypothesis_.R = RotationOf(m1_, m2, d1_, d2);
      const Vector3 t0 = 0.5F * (base_->a + base_->b) - hypothesis_.R * (0.5F * (base.a + base.b));
      hypothesis_.t = t0 + (corner - hypothesis_.R * model_corner - t0).dot(d1_) * d1_;
      Score();
    }
  }

  [[nodiscard]] float MinCosine(const ImageLinePair& pair) const {
    const float limit = std::min(1.2F, params_.direction_tolerance_rad + 2.5F * pair.angle_sigma_rad);
    return 1 - 0.5F * limit * limit;  // cosine of the limit, to second order
  }

  void MakeFromParallels() {
    const Vector3 base_middle = 0.5F * (base_->a + base_->b);
    const Vector3 other_middle = 0.5F * (other_->a + other_->b);
    const Vector3 model_base = 0.5F * (base_edge_->a + base_edge_->b);
    const Vector3 model_other = 0.5F * (other_edge_->a + other_edge_->b);
    const Vector3 model_across = Across(model_other - model_base, m1_);
    const Vector3 image_across = Across(other_middle - base_middle, d1_);
    if (model_across.norm() < 1e-3F || image_across.norm() < 1e-3F) return;
    hypothesis_.R = RotationOf(m1_, model_across, d1_, image_across);
    // Across the lines: the middle between both. Along them: each pair of end points in turn.
    const Vector3 offset = 0.5F * (base_middle + other_middle) - hypothesis_.R * (0.5F * (model_base + model_other));
    const Vector3 t0 = offset - offset.dot(d1_) * d1_;
    tried_.clear();
    AlignEnds(t0, *base_, *base_edge_);
    AlignEnds(t0, *other_, *other_edge_);
  }

  static Vector3 Across(const Vector3& v, const Vector3& axis) { return v - v.dot(axis) * axis; }

  void AlignEnds(const Vector3& t0, const Line3& line, const PreparedEdge& edge) {
    const float i0 = std::min(line.a.dot(d1_), line.b.dot(d1_));
    const float i1 = std::max(line.a.dot(d1_), line.b.dot(d1_));
    const float ea = (hypothesis_.R * edge.a).dot(d1_);
    const float eb = (hypothesis_.R * edge.b).dot(d1_);
    const float same = params_.same_alignment_px * base_->a.z() / f_;
    for (const float along : {i0 - std::min(ea, eb), i1 - std::max(ea, eb)}) {
      // Lines that show their whole edge are aligned at both ends alike.
      if (std::any_of(tried_.begin(), tried_.end(), [&](float t) { return std::abs(t - along) < same; })) continue;
      tried_.push_back(along);
      hypothesis_.t = t0 + along * d1_;
      Score();
    }
  }

  // The segment lies on the projected edge and within its ends. `a`, `b`: the edge's ends in the camera frame.
  [[nodiscard]] bool Covers(const Vector3& a, const Vector3& b, const Segment2& segment) const {
    if (a.z() < 0.05F || b.z() < 0.05F) return false;
    const float fa = f_ / a.z(), fb = f_ / b.z();
    const Vector2 origin(fa * a.x() + cx_, fa * a.y() + cy_);
    const Vector2 delta = Vector2(fb * b.x() + cx_, fb * b.y() + cy_) - origin;
    const float length = delta.norm();
    if (length < 3) return false;
    const Vector2 d = delta / length;
    const float slack = params_.end_tolerance_px + params_.end_tolerance_share * length;
    for (const Vector2& q : {segment.a, segment.b}) {
      const Vector2 p = q - origin;
      const float along = p.dot(d);
      const float across = std::abs(p.x() * d.y() - p.y() * d.x());
      if (along < -slack || along > length + slack || across > params_.end_tolerance_px) return false;
    }
    return true;
  }

  [[nodiscard]] bool Covers(const PreparedEdge& edge, const Segment2& segment) const {
    return Covers(hypothesis_.R * edge.a + hypothesis_.t, hypothesis_.R * edge.b + hypothesis_.t, segment);
  }

  void Score() {
    if (Covers(*base_edge_, base_->segment) && Covers(*other_edge_, other_->segment)) ScoreCovered();
  }

  // Of a pose at which both edges cover their segments.
  void ScoreCovered() {
    const Vector3 centre = hypothesis_.R * model_.centre + hypothesis_.t;
    if (centre.z() < params_.min_depth_m) return;
    const EdgeBits& visible = model_.EdgesSeenFrom(-(hypothesis_.R.transpose() * hypothesis_.t));
    if (!HasEdge(visible, hypothesis_.base_edge) || !HasEdge(visible, hypothesis_.other_edge)) return;
    if (!budget_.Spend(1)) return;
    PoseSupport support;
    if (!scorer_.Score(hypothesis_.R, hypothesis_.t, visible, support)) return;
    hypothesis_.score = support.score;
    out_.Push(hypothesis_);
  }

  const HypothesisParams& params_;
  const SceneEdges& scene_;
  const PreparedModel& model_;
  const Lines3& lines_;
  Hypotheses& out_;
  PoseScorer scorer_;
  float f_, cx_, cy_;
  // Of the pair at hand.
  const Line3* base_ = nullptr;
  const Line3* other_ = nullptr;
  const PreparedEdge* base_edge_ = nullptr;
  const PreparedEdge* other_edge_ = nullptr;
  Vector3 d1_, m1_;
  // Of MakeFromAngle: axes of the model's frame, its origin, and the other edge's ends in it.
  Matrix3 M_;
  Vector3 model_middle_, other_a_, other_b_;
  FixedVector<float, 4> tried_;  // of MakeFromParallels: positions along the lines, m
  Hypothesis hypothesis_;
  WorkBudget budget_;
};

}  // namespace

bool MakeHypotheses(const HypothesisParams& params, const SceneEdges& scene, const PreparedModel& model,
                    const Lines3& lines, const ImageLineSets& sets, std::span<const CorrespondingPair> pairs,
                    Hypotheses& out) {
  out.clear();
  HypothesisMaker maker(params, scene, model, lines, out);
  for (const CorrespondingPair& match : pairs) {
    if (maker.budget_hit()) break;
    maker.Make(match, sets.pairs[match.image_pair]);
  }
  return !maker.budget_hit();
}

}  // namespace wirepose
