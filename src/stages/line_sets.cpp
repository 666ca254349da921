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

// Squared.
float FarthestEnds(const Line3& p, const Line3& q) {
  return std::max(
      {(p.a - q.a).squaredNorm(), (p.a - q.b).squaredNorm(), (p.b - q.a).squaredNorm(), (p.b - q.b).squaredNorm()});
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
      : params_(params), lines_(lines), f_(static_cast<float>(camera.f)) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      length_px_[i] = lines[i].segment.Length();
      root_px_[i] = std::sqrt(length_px_[i]);
      image_direction_[i] = lines[i].segment.Direction();
      if (!lines[i].has_depth) continue;
      depth_[i] = 0.5F * (lines[i].a.z() + lines[i].b.z());
      direction_[i] = lines[i].Direction();
      direction_sigma_[i] = DirectionSigma(camera, lines[i]);
      depth_sigma_[i] = DepthSigma(camera, lines[i]);
    }
  }

  // The quality of two lines, as if they met. False when they are too far apart to be related.
  bool Rate(std::size_t b, std::size_t o, ImageLinePair& pair) const {
    pair = {};
    pair.base = static_cast<std::uint16_t>(b);
    pair.other = static_cast<std::uint16_t>(o);
    pair.metric = lines_[o].has_depth;
    // Without depth: two lines in a row.
    float reach = (length_px_[b] + length_px_[o]) / f_;
    float reach_squared = reach * reach;
    if (pair.metric) {
      const float farthest_squared = FarthestEnds(lines_[b], lines_[o]);
      const float limit = params_.max_reach_m + 3 * (depth_sigma_[b] + depth_sigma_[o]);
      if (farthest_squared > limit * limit) return false;
      reach_squared = farthest_squared / (depth_[b] * depth_[b]);
    }
    pair.quality = params_.junction_gain * root_px_[b] * root_px_[o] / reach_squared;
    return true;
  }

  // Which ends of two rated lines meet. False when that leaves them unrelated.
  bool Join(ImageLinePair& pair) const {
    const std::size_t b = pair.base, o = pair.other;
    const float ends_squared = NearestEnds(lines_[b].segment, lines_[o].segment, pair.base_end, pair.other_end);
    const float reach = std::min(params_.junction_px, 4 + 0.3F * std::min(length_px_[b], length_px_[o]));
    if (ends_squared < reach * reach && ImageSine(image_direction_[b], image_direction_[o]) > 0.2F) return true;
    pair.base_end = pair.other_end = LineEnd::kNone;
    pair.quality /= params_.junction_gain;
    return pair.metric;
  }

  // The whole pair of two lines that are related.
  void Make(std::size_t b, std::size_t o, ImageLinePair& pair) const {
    const bool related = Rate(b, o, pair) && Join(pair);
    Check(related);  // they were when the pair was ranked
    if (pair.metric) Measure(pair);
  }

 private:
  // The parameter vector of two lines with depth.
  void Measure(ImageLinePair& pair) const {
    const std::size_t b = pair.base, o = pair.other;
    const Vector3 &u = direction_[b], &v = direction_[o];
    const float sine = std::min(1.0F, u.cross(v).norm());
    const float cosine = std::abs(u.dot(v));
    // atan2 of non-negative numbers by the rational approximation below: good to 0.005 rad, far below any sigma here.
    pair.angle_rad = Angle(sine, cosine);
    pair.angle_sigma_rad =
        std::sqrt(direction_sigma_[b] * direction_sigma_[b] + direction_sigma_[o] * direction_sigma_[o]);
    pair.kind = pair.angle_rad < params_.parallel_rad + pair.angle_sigma_rad ? LineSetKind::kParallel
                                                                             : LineSetKind::kIntersecting;
    pair.distance_m = DistanceOfLines(lines_[b], lines_[o], u, v, sine);
    pair.distance_sigma_m = std::sqrt(depth_sigma_[b] * depth_sigma_[b] + depth_sigma_[o] * depth_sigma_[o]);
    pair.farthest_end_m = std::sqrt(FarthestEnds(lines_[b], lines_[o]));
    pair.log_angle_sigma = Log(pair.angle_sigma_rad + 0.02F);
    pair.log_distance_sigma = Log((pair.distance_sigma_m + 0.003F) / 0.01F);
  }

  static float Angle(float sine, float cosine) {
    const bool steep = sine > cosine;
    const float t = steep ? cosine / sine : sine / cosine;
    const float a = t * (0.78539816F + 0.273F * (1 - t));
    return steep ? 1.57079633F - a : a;
  }

  const LineSetParams& params_;
  const Lines3& lines_;
  float f_;
  std::array<float, kMaxSegments> length_px_{}, root_px_{};
  std::array<Vector2, kMaxSegments> image_direction_;
  // Of lines with depth.
  std::array<float, kMaxSegments> depth_{}, direction_sigma_{}, depth_sigma_{};
  std::array<Vector3, kMaxSegments> direction_;
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
      ImageLinePair pair;
      if (!maker.Rate(b, o, pair)) continue;
      // Most pairs are too weak to be kept, even if they met.
      if (!out.kept.WouldKeep({pair.quality, 0, 0}) || !maker.Join(pair)) continue;
      out.kept.Push({pair.quality, pair.base, pair.other});
    }
  }
  out.dropped = out.kept.dropped();
  GroupByBase(maker, lines.size(), out);
}

}  // namespace wirepose
