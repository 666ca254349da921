#include "stages/segments.h"

#include <algorithm>
#include <cmath>

#include "base/keep_best.h"

namespace wirepose {
namespace {

using Point = SegmentScratch::Point;

// The eight neighbours in order of angle (x right, y down).
constexpr int kDx[8] = {1, 1, 0, -1, -1, -1, 0, 1};
constexpr int kDy[8] = {0, 1, 1, 1, 0, -1, -1, -1};

// The neighbour nearest to direction (x, y): octants end at tan(22.5 degrees).
int Octant(int x, int y) {
  constexpr float kTan = 0.41421356F;
  const auto ax = static_cast<float>(std::abs(x));
  const auto ay = static_cast<float>(std::abs(y));
  if (ay <= kTan * ax) return x > 0 ? 0 : 4;
  if (ax <= kTan * ay) return y > 0 ? 2 : 6;
  if (x > 0) return y > 0 ? 1 : 7;
  return y > 0 ? 3 : 5;
}

class ChainWalker {
 public:
  ChainWalker(EdgeImage& edges, float min_cosine) : edges_(edges), min_cosine_(min_cosine) {}

  // Follows the edge through `seed` both ways and returns the pixels in order, from the end with the brighter side on
  // its right. Visited pixels are no longer ridges.
  std::size_t Walk(std::uint32_t seed, std::array<std::uint32_t, kMaxChain>& chain) {
    edges_.ridge[seed] = 0;
    chain[0] = seed;
    std::size_t count = Follow(seed, -1, chain, 1);
    std::reverse(chain.begin(), chain.begin() + static_cast<std::ptrdiff_t>(count));
    return Follow(seed, 1, chain, count);
  }

 private:
  // `sense` +1 walks with the brighter side on the right: along (gy, -gx).
  std::size_t Follow(std::uint32_t from, int sense, std::array<std::uint32_t, kMaxChain>& chain, std::size_t count) {
    std::uint32_t at = from;
    while (count < kMaxChain) {
      const int direction = Octant(sense * edges_.gy[at], -sense * edges_.gx[at]);
      std::uint32_t next = Best(at, at, direction);
      if (next == at) next = AcrossGap(at, direction);
      if (next == at) break;
      edges_.ridge[next] = 0;
      chain[count++] = next;
      at = next;
    }
    return count;
  }

  // The strongest compatible ridge pixel among the three neighbours of `around` ahead, else `at`.
  [[nodiscard]] std::uint32_t Best(std::uint32_t at, std::uint32_t around, int direction) const {
    std::uint32_t best = at;
    int best_magnitude = 0;
    for (int turn : {0, 1, -1}) {
      const auto d = static_cast<std::size_t>((direction + turn + 8) % 8);
      const std::uint32_t i = static_cast<std::uint32_t>(static_cast<int>(around) + kDy[d] * kMaxImageWidth + kDx[d]);
      if (edges_.ridge[i] == 0 || edges_.magnitude[i] <= best_magnitude || !Compatible(at, i)) continue;
      best = i;
      best_magnitude = edges_.magnitude[i];
    }
    return best;
  }

  // One missing pixel is stepped over. Ridges keep 3 pixels from the border, so two steps stay inside.
  [[nodiscard]] std::uint32_t AcrossGap(std::uint32_t at, int direction) const {
    const auto d = static_cast<std::size_t>(direction);
    const auto ahead = static_cast<std::uint32_t>(static_cast<int>(at) + kDy[d] * kMaxImageWidth + kDx[d]);
    return Best(at, ahead, direction);
  }

  [[nodiscard]] bool Compatible(std::uint32_t i, std::uint32_t j) const {
    const int dot = edges_.gx[i] * edges_.gx[j] + edges_.gy[i] * edges_.gy[j];
    return static_cast<float>(dot) >=
           min_cosine_ * static_cast<float>(edges_.magnitude[i]) * static_cast<float>(edges_.magnitude[j]);
  }

  EdgeImage& edges_;
  float min_cosine_;
};

// Sub-pixel ridge position: the vertex of the parabola through three magnitudes across the edge.
Point RefinePixel(const EdgeImage& edges, std::uint32_t i) {
  const bool across_x = std::abs(int{edges.gx[i]}) >= std::abs(int{edges.gy[i]});
  const std::uint32_t step = across_x ? 1 : kMaxImageWidth;
  const auto before = static_cast<float>(edges.magnitude[i - step]);
  const auto here = static_cast<float>(edges.magnitude[i]);
  const auto after = static_cast<float>(edges.magnitude[i + step]);
  const float bend = before - 2 * here + after;
  const float shift = bend < -1 ? std::clamp(0.5F * (before - after) / bend, -0.5F, 0.5F) : 0.0F;
  const auto x = static_cast<float>(i % kMaxImageWidth);
  const auto y = static_cast<float>(i / kMaxImageWidth);
  return {across_x ? x + shift : x, across_x ? y : y + shift, here};
}

// Running sums of a weighted line fit.
struct FitSums {
  double w = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  int n = 0;

  void Add(const Point& p) {
    const double v = static_cast<double>(p.weight);
    const double px = static_cast<double>(p.x);
    const double py = static_cast<double>(p.y);
    w += v;
    x += v * px;
    y += v * py;
    xx += v * px * px;
    xy += v * px * py;
    yy += v * py * py;
    ++n;
  }
};

struct LineFit {
  Eigen::Vector2d centre, direction;
  double across = 0;  // variance across the line, px^2
  double along = 0;   // variance along it, px^2
};

// Principal axes of the weighted points: the direction is the eigenvector of the larger eigenvalue, in closed form.
LineFit Fit(const FitSums& s) {
  LineFit fit;
  fit.centre = {s.x / s.w, s.y / s.w};
  const double cxx = s.xx / s.w - fit.centre.x() * fit.centre.x();
  const double cxy = s.xy / s.w - fit.centre.x() * fit.centre.y();
  const double cyy = s.yy / s.w - fit.centre.y() * fit.centre.y();
  const double half = 0.5 * (cxx - cyy);
  const double root = std::sqrt(half * half + cxy * cxy);
  // The better conditioned of the two expressions for the eigenvector.
  fit.direction = half > 0 ? Eigen::Vector2d(half + root, cxy) : Eigen::Vector2d(cxy, root - half);
  const double norm = fit.direction.norm();
  fit.direction = norm > 0 ? Eigen::Vector2d(fit.direction / norm) : Eigen::Vector2d(1, 0);
  fit.across = std::max(0.0, 0.5 * (cxx + cyy) - root);
  fit.along = 0.5 * (cxx + cyy) + root;
  return fit;
}

double Across(const LineFit& fit, const Point& p) {
  return (static_cast<double>(p.x) - fit.centre.x()) * -fit.direction.y() +
         (static_cast<double>(p.y) - fit.centre.y()) * fit.direction.x();
}

// Fits points [begin, end) twice: all, then those within 1 px or two deviations. False when they are no line.
bool FitPiece(const SegmentParams& params, const Point* begin, const Point* end, Segment2& out) {
  FitSums all;
  for (const Point* p = begin; p != end; ++p) all.Add(*p);
  LineFit fit = Fit(all);
  const double gate = std::clamp(2 * std::sqrt(fit.across), 0.5, 1.0);
  FitSums good;
  for (const Point* p = begin; p != end; ++p) {
    if (std::abs(Across(fit, *p)) < gate) good.Add(*p);
  }
  if (good.n * 4 < all.n * 3) return false;
  fit = Fit(good);
  if (fit.across > static_cast<double>(params.max_rms_px * params.max_rms_px)) return false;
  const auto along = [&](const Point& p) {
    return (static_cast<double>(p.x) - fit.centre.x()) * fit.direction.x() +
           (static_cast<double>(p.y) - fit.centre.y()) * fit.direction.y();
  };
  double s0 = along(*begin), s1 = along(*(end - 1));
  if (s0 > s1) {  // keep the chain's sense, which carries the polarity
    fit.direction = -fit.direction;
    s0 = -s0;
    s1 = -s1;
  }
  if (s1 - s0 < static_cast<double>(params.min_length_px)) return false;
  out.a = (fit.centre + s0 * fit.direction).cast<float>();
  out.b = (fit.centre + s1 * fit.direction).cast<float>();
  out.contrast = static_cast<float>(good.w / good.n / kGradientOne);
  // Smoothing makes neighbouring points dependent: about every second one is news. The floor is what sampling leaves.
  const double n = 0.5 * good.n;
  const double sigma = std::sqrt(fit.across + 0.01);
  out.sigma_offset_px = static_cast<float>(std::max(0.03, sigma / std::sqrt(n)));
  out.sigma_angle_rad = static_cast<float>(std::max(0.001, sigma / std::sqrt(n * std::max(1.0, fit.along))));
  return true;
}

// Farthest point from the chord of [begin, end): its index and distance.
std::pair<std::size_t, float> FarthestFromChord(const Point* p, std::size_t begin, std::size_t end) {
  const Vector2 a(p[begin].x, p[begin].y);
  const Vector2 d = Vector2(p[end - 1].x, p[end - 1].y) - a;
  const float length = std::max(d.norm(), 1e-3F);
  std::size_t at = begin;
  float farthest = 0;
  for (std::size_t i = begin + 1; i + 1 < end; ++i) {
    const float distance = std::abs((p[i].x - a.x()) * d.y() - (p[i].y - a.y()) * d.x()) / length;
    if (distance > farthest) {
      farthest = distance;
      at = i;
    }
  }
  return {at, farthest};
}

struct Longer {
  bool operator()(const Segment2& p, const Segment2& q) const {
    const float lp = p.Delta().squaredNorm();
    const float lq = q.Delta().squaredNorm();
    if (lp != lq) return lp > lq;
    return std::pair(p.a.x(), p.a.y()) < std::pair(q.a.x(), q.a.y());
  }
};
using Collector = KeepBest<Segment2, kMaxSegments, Longer>;

// Splits a chain where it bends (Ramer-Douglas-Peucker with a bounded stack) and collects the straight pieces.
void SplitChain(const SegmentParams& params, const Point* points, std::size_t count, Collector& collector) {
  struct Range {
    std::size_t begin, end;
  };
  FixedVector<Range, 64> stack;
  stack.push_back({0, count});
  while (!stack.empty()) {
    const Range range = stack.back();
    stack.pop_back();
    if (static_cast<float>(range.end - range.begin) < 0.7F * params.min_length_px) continue;
    const auto [at, distance] = FarthestFromChord(points, range.begin, range.end);
    if (distance > params.max_deviation_px && stack.size() + 2 <= stack.capacity()) {
      stack.push_back({range.begin, at + 1});
      stack.push_back({at, range.end});
      continue;
    }
    Segment2 segment;
    if (FitPiece(params, points + range.begin, points + range.end, segment)) collector.Push(segment);
  }
}

// What the test for joining needs of every segment, kept beside the list.
struct Shape {
  Vector2 direction;
  float length;
};

Shape ShapeOf(const Segment2& s) {
  const float length = s.Length();
  return {s.Delta() / length, length};
}

// True when q continues p: same polarity, same line, small gap.
bool Continues(const SegmentParams& params, const Segment2& p, const Shape& ps, const Segment2& q, const Shape& qs) {
  const Vector2& d = ps.direction;
  if (d.dot(qs.direction) < 0.9F) return false;
  const Vector2 a = q.a - p.a, b = q.b - p.a;
  if (std::abs(a.y() * d.x() - a.x() * d.y()) > params.join_offset_px) return false;
  if (std::abs(b.y() * d.x() - b.x() * d.y()) > params.join_offset_px) return false;
  const float sine = std::abs(d.x() * qs.direction.y() - d.y() * qs.direction.x());
  if (sine > params.join_angle_rad + p.sigma_angle_rad + q.sigma_angle_rad) return false;
  const float shorter = std::min(ps.length, qs.length);
  const float gap = std::max(a.dot(d) - ps.length, -b.dot(d));  // negative: they overlap
  if (gap > params.max_gap_share * shorter || gap < -0.3F * shorter) return false;
  return std::min(p.contrast, q.contrast) >= 0.3F * std::max(p.contrast, q.contrast);
}

// Both as one: middles and directions, weighted by the information that each piece has.
Segment2 Joined(const Segment2& p, const Shape& ps, const Segment2& q, const Shape& qs) {
  const float wp = ps.length / (ps.length + qs.length), wq = 1 - wp;
  const Vector2 centre = wp * p.Middle() + wq * q.Middle();
  const float spread = 3 * wp * wq;  // lever arm of the two middles against the pieces' own directions
  Vector2 between = q.Middle() - p.Middle();
  if (between.dot(ps.direction) < 0) between = -between;
  const Vector2 direction =
      (wp * wp * wp * ps.direction + wq * wq * wq * qs.direction + spread * between.normalized()).normalized();
  const float t0 = std::min((p.a - centre).dot(direction), (q.a - centre).dot(direction));
  const float t1 = std::max((p.b - centre).dot(direction), (q.b - centre).dot(direction));
  Segment2 joined = p;
  joined.a = centre + t0 * direction;
  joined.b = centre + t1 * direction;
  joined.contrast = wp * p.contrast + wq * q.contrast;
  joined.sigma_offset_px = std::min(p.sigma_offset_px, q.sigma_offset_px);
  joined.sigma_angle_rad = std::min(p.sigma_angle_rad, q.sigma_angle_rad);
  return joined;
}

// Longest first; a segment that grew is tried against the rest once more.
void JoinCollinear(const SegmentParams& params, FixedVector<Segment2, kMaxSegments>& items) {
  std::array<Shape, kMaxSegments> shapes;
  for (std::size_t i = 0; i < items.size(); ++i) shapes[i] = ShapeOf(items[i]);
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (int pass = 0; pass < 2; ++pass) {
      std::size_t kept = i + 1;
      for (std::size_t j = i + 1; j < items.size(); ++j) {
        if (Continues(params, items[i], shapes[i], items[j], shapes[j])) {
          items[i] = Joined(items[i], shapes[i], items[j], shapes[j]);
          shapes[i] = ShapeOf(items[i]);
        } else {
          if (kept != j) {
            items[kept] = items[j];
            shapes[kept] = shapes[j];
          }
          ++kept;
        }
      }
      if (kept == items.size()) break;
      items.resize(kept);
    }
  }
  std::sort(items.begin(), items.end(), Longer{});
}

}  // namespace

void FindSegments(const SegmentParams& params, EdgeImage& edges, SegmentScratch& scratch, Segments& out) {
  Collector collector;
  ChainWalker walker(edges, params.min_cosine);
  SortRidges(edges);
  for (std::uint32_t k = 0; k < edges.ridge_count; ++k) {
    const std::uint32_t seed = edges.by_magnitude[k];
    if (edges.ridge[seed] == 0) continue;
    const std::size_t count = walker.Walk(seed, scratch.chain);
    if (static_cast<float>(count) < 0.7F * params.min_length_px) continue;
    for (std::size_t i = 0; i < count; ++i) scratch.points[i] = RefinePixel(edges, scratch.chain[i]);
    SplitChain(params, scratch.points.data(), count, collector);
  }
  out.items = collector.Sorted();
  out.dropped = collector.dropped();
  JoinCollinear(params, out.items);
}

}  // namespace wirepose
