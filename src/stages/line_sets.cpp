#include "stages/line_sets.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/portable_math.h"

namespace wirepose {
namespace {

// `u`, `v`: the lines' directions.
float DistanceOfLines(const Line3& p, const Line3& q, const Vector3& u, const Vector3& v, float sine) {
  const Vector3 between = 0.5F * (q.a + q.b) - 0.5F * (p.a + p.b);
  if (sine < 0.2F) return (between - between.dot(u) * u).norm();  // nearly parallel: distance of q's middle from p
  const Vector3 n = u.cross(v);
  return std::abs(between.dot(n)) / n.norm();
}

float FarthestEnds(const Line3& p, const Line3& q) {
  const float squared = std::max(
      {(p.a - q.a).squaredNorm(), (p.a - q.b).squaredNorm(), (p.b - q.a).squaredNorm(), (p.b - q.b).squaredNorm()});
  return std::sqrt(squared);
}

// The nearest pair of end points in the image, and how far apart they are, squared.
float NearestEnds(const Segment2& p, const Segment2& q, LineEnd& p_end, LineEnd& q_end) {
  const Vector2 pe[2] = {p.a, p.b};
  const Vector2 qe[2] = {q.a, q.b};
  float nearest = 1e9F;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const float d = (pe[i] - qe[j]).squaredNorm();
      if (d >= nearest) continue;
      nearest = d;
      p_end = static_cast<LineEnd>(i);
      q_end = static_cast<LineEnd>(j);
    }
  }
  return nearest;
}

// Sine of the angle between two directions in the image.
float ImageSine(const Vector2& u, const Vector2& v) { return std::abs(u.x() * v.y() - u.y() * v.x()); }

class PairMaker {
 public:
  PairMaker(const LineSetParams& params, const RectifiedCamera& camera, const Lines3& lines)
      : params_(params), lines_(lines) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      length_px_[i] = lines[i].segment.Length();
      image_direction_[i] = lines[i].segment.Direction();
      log_length_[i] = Log(length_px_[i]);
      if (!lines[i].has_depth) continue;
      direction_[i] = lines[i].Direction();
      direction_sigma_[i] = DirectionSigma(camera, lines[i]);
      depth_sigma_[i] = DepthSigma(camera, lines[i]);
      log_angle_[i] = Log(OfAngle(direction_sigma_[i]));
      log_distance_[i] = Log(OfDistance(depth_sigma_[i]));
    }
  }

  // No pair of these two lines has a higher quality, unless they meet: the joint sigmas are at least the larger ones.
  [[nodiscard]] float QualityBound(std::size_t b, std::size_t o) const {
    float bound = log_length_[b] + log_length_[o] + kRounding;
    if (lines_[o].has_depth)
      bound -= std::max(log_angle_[b], log_angle_[o]) + std::max(log_distance_[b], log_distance_[o]);
    return bound;
  }

  // Two lines, and which of their ends meet. True when some do.
  bool Join(std::size_t b, std::size_t o, ImageLinePair& pair) const {
    const Line3& base = lines_[b];
    const Line3& other = lines_[o];
    pair = {};
    pair.base = static_cast<std::uint16_t>(b);
    pair.other = static_cast<std::uint16_t>(o);
    const float ends_squared = NearestEnds(base.segment, other.segment, pair.base_end, pair.other_end);
    const float reach = std::min(params_.junction_px, 4 + 0.3F * std::min(length_px_[b], length_px_[o]));
    const bool junction = std::sqrt(ends_squared) < reach && ImageSine(image_direction_[b], image_direction_[o]) > 0.2F;
    if (!junction) pair.base_end = pair.other_end = LineEnd::kNone;
    return junction;
  }

  // The quality of two joined lines, which tells whether the rest is worth the work. False when they are not related.
  bool Rate(ImageLinePair& pair) const {
    const std::size_t b = pair.base, o = pair.other;
    const bool junction = pair.base_end != LineEnd::kNone;
    pair.quality = log_length_[b] + log_length_[o] + (junction ? params_.junction_quality : 0.0F);
    if (!lines_[o].has_depth) return junction;
    pair.metric = true;
    pair.farthest_end_m = FarthestEnds(lines_[b], lines_[o]);
    if (pair.farthest_end_m > params_.max_reach_m + 3 * (depth_sigma_[b] + depth_sigma_[o])) return false;
    pair.angle_sigma_rad =
        std::sqrt(direction_sigma_[b] * direction_sigma_[b] + direction_sigma_[o] * direction_sigma_[o]);
    pair.distance_sigma_m = std::sqrt(depth_sigma_[b] * depth_sigma_[b] + depth_sigma_[o] * depth_sigma_[o]);
    // Normalisation of the two Gaussians that V is compared with, relative to a rad of 1 and a distance of 1 cm.
    pair.quality -= Log(OfAngle(pair.angle_sigma_rad) * OfDistance(pair.distance_sigma_m));
    return true;
  }

  // The whole pair of two lines that are related.
  void Make(std::size_t b, std::size_t o, ImageLinePair& pair) const {
    Join(b, o, pair);
    const bool related = Rate(pair);
    Check(related);  // Rate said so when the pair was ranked
    if (pair.metric) Measure(b, o, pair);
  }

 private:
  // The parameter vector of two lines with depth.
  void Measure(std::size_t b, std::size_t o, ImageLinePair& pair) const {
    const Vector3 &u = direction_[b], &v = direction_[o];
    const float sine = std::min(1.0F, u.cross(v).norm());
    const float cosine = std::abs(u.dot(v));
    // atan2 of non-negative numbers by the rational approximation below: good to 0.005 rad, far below any sigma here.
    pair.angle_rad = Angle(sine, cosine);
    pair.kind = pair.angle_rad < params_.parallel_rad + pair.angle_sigma_rad ? LineSetKind::kParallel
                                                                             : LineSetKind::kIntersecting;
    pair.distance_m = DistanceOfLines(lines_[b], lines_[o], u, v, sine);
    pair.log_angle_sigma = Log(OfAngle(pair.angle_sigma_rad));
    pair.log_distance_sigma = Log(OfDistance(pair.distance_sigma_m));
  }

  static constexpr float kRounding = 1e-3F;  // far more than what a bound may be too low by

  static float OfAngle(float sigma_rad) { return sigma_rad + 0.02F; }
  static float OfDistance(float sigma_m) { return (sigma_m + 0.003F) / 0.01F; }

  static float Angle(float sine, float cosine) {
    const bool steep = sine > cosine;
    const float t = steep ? cosine / sine : sine / cosine;
    const float a = t * (0.78539816F + 0.273F * (1 - t));
    return steep ? 1.57079633F - a : a;
  }

  const LineSetParams& params_;
  const Lines3& lines_;
  std::array<float, kMaxSegments> direction_sigma_{}, depth_sigma_{}, log_length_{}, log_angle_{}, log_distance_{};
  std::array<float, kMaxSegments> length_px_{};
  std::array<Vector2, kMaxSegments> image_direction_;
  std::array<Vector3, kMaxSegments> direction_;  // of lines with depth
};

// Counting sort of the kept pairs by base line. Within a base they stay in the order of quality. What was kept is
// measured now.
void GroupByBase(const PairMaker& maker, std::size_t line_count, ImageLineSets& out) {
  const auto& kept = out.kept.Sorted();
  out.first.fill(0);
  for (const RankedImagePair& pair : kept) ++out.first[pair.base + 1U];
  for (std::size_t b = 0; b < line_count; ++b)
    out.first[b + 1] = static_cast<std::uint16_t>(out.first[b + 1] + out.first[b]);
  out.pairs.resize(kept.size());
  std::array<std::uint16_t, kMaxSegments> next;
  std::copy(out.first.begin(), out.first.end() - 1, next.begin());
  for (const RankedImagePair& pair : kept) maker.Make(pair.base, pair.other, out.pairs[next[pair.base]++]);
}

}  // namespace

float DepthSigma(const RectifiedCamera& camera, const Line3& line) {
  const auto z = static_cast<double>(0.5F * (line.a.z() + line.b.z()));
  const auto variance = static_cast<double>(0.25F * (line.var_a + line.var_b + 2 * line.cov_ab));
  return static_cast<float>(z * z / (camera.f * camera.baseline) * std::sqrt(std::max(variance, 0.0)));
}

float DirectionSigma(const RectifiedCamera& camera, const Line3& line) {
  const auto z = static_cast<double>(0.5F * (line.a.z() + line.b.z()));
  const auto variance = static_cast<double>(line.var_a + line.var_b - 2 * line.cov_ab);
  const double depth_difference = z * z / (camera.f * camera.baseline) * std::sqrt(std::max(variance, 0.0));
  // Of the part of the direction across the line of sight; what turns out of the image plane is what depth turns.
  const double length = std::max(1e-4, static_cast<double>(line.Length()));
  return static_cast<float>(
      std::min(1.5, depth_difference / length + static_cast<double>(line.segment.sigma_angle_rad)));
}

void FindLineSets(const LineSetParams& params, const RectifiedCamera& camera, const Lines3& lines, ImageLineSets& out) {
  out.kept.clear();
  const PairMaker maker(params, camera, lines);
  for (std::size_t b = 0; b < lines.size(); ++b) {
    if (!lines[b].has_depth || lines[b].segment.Length() < params.min_depth_length_px) continue;
    for (std::size_t o = 0; o < lines.size(); ++o) {
      // Of two lines with depth the longer one, which comes first, is the base: model sets hold both orders.
      if (o == b || (o < b && lines[o].has_depth)) continue;
      // Most pairs are too weak to be kept: the sooner that is known, the better.
      const float bound = maker.QualityBound(b, o);
      if (!out.kept.WouldKeep({bound + params.junction_quality, 0, 0})) continue;
      ImageLinePair pair;
      if (!maker.Join(b, o, pair) && !out.kept.WouldKeep({bound, 0, 0})) continue;
      if (!maker.Rate(pair)) continue;
      out.kept.Push({pair.quality, pair.base, pair.other});
    }
  }
  out.dropped = out.kept.dropped();
  GroupByBase(maker, lines.size(), out);
}

}  // namespace wirepose
