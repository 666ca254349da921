#include "stages/line_sets.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/portable_math.h"
#include "base/simd.h"

namespace wirepose {
namespace {

float FarthestEnds(const Line3& p, const Line3& q) {
  const float squared = std::max(
      {(p.a - q.a).squaredNorm(), (p.a - q.b).squaredNorm(), (p.b - q.a).squaredNorm(), (p.b - q.b).squaredNorm()});
  return std::sqrt(squared);
}

// `u`, `v`: the lines' directions.
float DistanceOfLines(const Line3& p, const Line3& q, const Vector3& u, const Vector3& v, float sine) {
  const Vector3 between = 0.5F * (q.a + q.b) - 0.5F * (p.a + p.b);
  if (sine < 0.2F) return (between - between.dot(u) * u).norm();  // nearly parallel: distance of q's middle from p
  const Vector3 n = u.cross(v);
  return std::abs(between.dot(n)) / n.norm();
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

// What the quality of pairs needs of all lines, number by number.
struct LineArrays {
  std::array<float, kMaxSegments> length_px{};
  std::array<float, kMaxSegments> depth_m{};  // at the middle; 0: unknown, and so all that follows
  std::array<float, kMaxSegments> ax{}, ay{}, az{}, bx{}, by{}, bz{}, depth_sigma{};
};

struct RateFactors {
  float gain;         // of a junction
  float max_reach_m;  // beyond three sigma of both depths
  float f;
};

// quality[o]: of base line b and every line o, as if they met; 0: too far apart to be related.
WIREPOSE_VECTOR_KERNEL void RatePairs(const LineArrays& l, std::size_t count, std::size_t b, const RateFactors& factors,
                                      float* quality) {
  const float pax = l.ax[b], pay = l.ay[b], paz = l.az[b], pbx = l.bx[b], pby = l.by[b], pbz = l.bz[b];
  const float length = l.length_px[b], sigma = l.depth_sigma[b];
  const float base = factors.gain * length, px_per_m = factors.f / l.depth_m[b];
  for (std::size_t o = 0; o < count; ++o) {
    const float aax = l.ax[o] - pax, aay = l.ay[o] - pay, aaz = l.az[o] - paz;
    const float abx = l.bx[o] - pax, aby = l.by[o] - pay, abz = l.bz[o] - paz;
    const float bax = l.ax[o] - pbx, bay = l.ay[o] - pby, baz = l.az[o] - pbz;
    const float bbx = l.bx[o] - pbx, bby = l.by[o] - pby, bbz = l.bz[o] - pbz;
    const float aa = aax * aax + aay * aay + aaz * aaz, ab = abx * abx + aby * aby + abz * abz;
    const float ba = bax * bax + bay * bay + baz * baz, bb = bbx * bbx + bby * bby + bbz * bbz;
    const float of_a = aa > ab ? aa : ab, of_b = ba > bb ? ba : bb;
    const float farthest = of_a > of_b ? of_a : of_b;  // squared
    const float limit = factors.max_reach_m + 3 * (sigma + l.depth_sigma[o]);
    const bool metric = l.depth_m[o] > 0;
    const float row = length + l.length_px[o];  // without depth: both lines in a row
    const float reach_px2 = metric ? farthest * px_per_m * px_per_m : row * row;
    const float rated = base * l.length_px[o] / reach_px2;
    quality[o] = metric && farthest > limit * limit ? 0 : rated;
  }
}

class PairMaker {
 public:
  PairMaker(const LineSetParams& params, const RectifiedCamera& camera, const Lines3& lines)
      : params_(params),
        lines_(lines),
        factors_{params.junction_gain, params.max_reach_m, static_cast<float>(camera.f)} {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Line3& line = lines[i];
      arrays_.length_px[i] = line.segment.Length();
      image_direction_[i] = line.segment.Direction();
      if (!line.has_depth) continue;
      arrays_.depth_m[i] = 0.5F * (line.a.z() + line.b.z());
      arrays_.ax[i] = line.a.x(), arrays_.ay[i] = line.a.y(), arrays_.az[i] = line.a.z();
      arrays_.bx[i] = line.b.x(), arrays_.by[i] = line.b.y(), arrays_.bz[i] = line.b.z();
      arrays_.depth_sigma[i] = DepthSigma(camera, line);
      direction_[i] = line.Direction();
      direction_sigma_[i] = DirectionSigma(camera, line);
    }
  }

  // The quality of base line b with every other line, as if they met; 0: too far apart to be related. Good until the
  // next call.
  [[nodiscard]] std::span<const float> Rate(std::size_t b) {
    RatePairs(arrays_, lines_.size(), b, factors_, quality_.data());
    return {quality_.data(), lines_.size()};
  }

  // Two lines, which of their ends meet, and what is left of their quality if none do. False when they are not related:
  // a line without depth must meet the other one.
  bool Join(std::size_t b, std::size_t o, float quality, ImageLinePair& pair) const {
    pair = {};
    pair.base = static_cast<std::uint16_t>(b);
    pair.other = static_cast<std::uint16_t>(o);
    pair.metric = lines_[o].has_depth;
    pair.quality = quality;
    const float ends_squared = NearestEnds(lines_[b].segment, lines_[o].segment, pair.base_end, pair.other_end);
    const float shorter = std::min(arrays_.length_px[b], arrays_.length_px[o]);
    const float reach = std::min(params_.junction_px, 4 + 0.3F * shorter);
    if (ends_squared < reach * reach && ImageSine(image_direction_[b], image_direction_[o]) > 0.2F) return true;
    pair.base_end = pair.other_end = LineEnd::kNone;
    pair.quality /= params_.junction_gain;
    return pair.metric;
  }

  // The whole pair of two lines that are related.
  void Make(const RankedImagePair& ranked, ImageLinePair& pair) const {
    const bool related = Join(ranked.base, ranked.other, 0, pair);
    Check(related);  // they were when the pair was ranked
    pair.quality = ranked.quality;
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
    const float base_sigma = arrays_.depth_sigma[b], other_sigma = arrays_.depth_sigma[o];
    pair.distance_sigma_m = std::sqrt(base_sigma * base_sigma + other_sigma * other_sigma);
    pair.farthest_end_m = FarthestEnds(lines_[b], lines_[o]);
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
  RateFactors factors_;
  LineArrays arrays_;
  std::array<Vector2, kMaxSegments> image_direction_;
  std::array<Vector3, kMaxSegments> direction_;  // of lines with depth
  std::array<float, kMaxSegments> direction_sigma_{};
  std::array<float, kMaxSegments> quality_;
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
  for (const RankedImagePair& pair : kept) maker.Make(pair, out.pairs[next[pair.base]++]);
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
  PairMaker maker(params, camera, lines);
  for (std::size_t b = 0; b < lines.size(); ++b) {
    if (!lines[b].has_depth || lines[b].segment.Length() < params.min_depth_length_px) continue;
    const std::span<const float> quality = maker.Rate(b);
    for (std::size_t o = 0; o < lines.size(); ++o) {
      // Most pairs are unrelated or too weak to be kept, even if they met.
      if (quality[o] <= 0 || !out.kept.WouldKeep({quality[o], 0, 0})) continue;
      // Of two lines with depth the longer one, which comes first, is the base: model sets hold both orders.
      if (o == b || (o < b && lines[o].has_depth)) continue;
      ImageLinePair pair;
      if (maker.Join(b, o, quality[o], pair)) out.kept.Push({pair.quality, pair.base, pair.other});
    }
  }
  out.dropped = out.kept.dropped();
  GroupByBase(maker, lines.size(), out);
}

}  // namespace wirepose
