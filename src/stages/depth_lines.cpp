#include "stages/depth_lines.h"

#include <algorithm>
#include <cmath>

namespace wirepose {
namespace {

constexpr int kAcross = 4;  // samples across a strip

struct StripSample {
  float along;   // -1/2 at the segment's a, 1/2 at its b
  float across;  // distance from the segment, as a share of the strip's far side
  float d;       // px
};

// One side of a segment: what is known there, and of how many places.
struct Strip {
  FixedVector<StripSample, kMaxStripSamples> samples;
  int places = 0;
};

void ReadStrip(const DepthLineParams& params, const DisparityImage& depth, const Segment2& s, const Vector2& outwards,
               Strip& out) {
  out.samples.clear();
  const int n =
      std::clamp(static_cast<int>(s.Length() / params.step_px), 4, static_cast<int>(kMaxStripSamples) / kAcross);
  out.places = n * kAcross;
  for (int i = 0; i < n; ++i) {
    const float t = (static_cast<float>(i) + 0.5F) / static_cast<float>(n);
    for (int k = 0; k < kAcross; ++k) {
      const float offset = params.first_px + static_cast<float>(k) * (params.last_px - params.first_px) / (kAcross - 1);
      const Vector2 p = s.a + t * s.Delta() + offset * outwards;
      const int x = static_cast<int>(std::floor(p.x() + 0.5F)), y = static_cast<int>(std::floor(p.y() + 0.5F));
      if (!depth.Contains(x, y)) continue;
      const float d = depth.At(x, y);
      if (d > 0) out.samples.push_back({t - 0.5F, offset / params.last_px, d});
    }
  }
}

// Median disparity of the samples with `along` in [from, to); 0 when there are fewer than three.
float MedianBetween(const Strip& strip, float from, float to) {
  std::array<float, kMaxStripSamples> d;
  std::size_t n = 0;
  for (const StripSample& s : strip.samples) {
    if (s.along >= from && s.along < to) d[n++] = s.d;
  }
  if (n < 3) return 0;
  const auto middle = d.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(d.begin(), middle, d.begin() + static_cast<std::ptrdiff_t>(n));
  return *middle;
}

// d = p + q * along + r * across.
struct PlaneFit {
  Vector3d pqr = Vector3d::Zero();
  Matrix3d covariance = Matrix3d::Zero();  // of p, q, r
  bool found = false;

  [[nodiscard]] double middle() const { return pqr(0); }
  [[nodiscard]] double slope() const { return pqr(1); }
};

// From the medians of the outer thirds: right as long as less than half of each is something else.
PlaneFit FitPlane(const DepthLineParams& params, const Strip& strip) {
  PlaneFit fit;
  if (strip.samples.size() < 8) return fit;
  const float a = MedianBetween(strip, -0.5F, -1.0F / 6), b = MedianBetween(strip, 1.0F / 6, 0.5F);
  if (a <= 0 || b <= 0) return fit;
  fit.pqr = {0.5 * static_cast<double>(a + b), 1.5 * static_cast<double>(b - a), 0};
  constexpr std::array<float, 6> kScales = {6, 4, 2, 1, 1, 1};
  Matrix3d H;
  double weight = 0, squares = 0;
  for (const float wide : kScales) {
    const auto scale = static_cast<double>(wide * params.scale_px);
    // Priors where the samples do not tell: 5 px along the line, 3 px across the strip.
    H = Vector3d(0, 1 / 25.0, 1 / 9.0).asDiagonal();
    Vector3d g = -H * fit.pqr;
    weight = squares = 0;
    for (const StripSample& s : strip.samples) {
      const Vector3d row(1, static_cast<double>(s.along), static_cast<double>(s.across));
      const double e = static_cast<double>(s.d) - row.dot(fit.pqr);
      const double k = 1 / (1 + e * e / (scale * scale));
      const double w = k * k;  // Geman-McClure
      H += w * row * row.transpose();
      g += w * e * row;
      weight += w;
      squares += w * e * e;
    }
    const Eigen::LDLT<Matrix3d> ldlt(H);
    if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 1e-6)) return fit;
    fit.pqr += ldlt.solve(g);
  }
  if (!fit.pqr.allFinite() || weight < static_cast<double>(params.min_support) * strip.places) return fit;
  const double sigma = static_cast<double>(params.sigma_inflation) * std::max(std::sqrt(squares / weight), 0.05);
  fit.covariance = sigma * sigma * H.inverse();
  fit.found = true;
  return fit;
}

// The mean of two sides that agree, by their certainty.
PlaneFit Mean(const PlaneFit& p, const PlaneFit& q) {
  const double share = q.covariance(0, 0) / (p.covariance(0, 0) + q.covariance(0, 0));
  PlaneFit mean;
  mean.pqr = share * p.pqr + (1 - share) * q.pqr;
  mean.covariance = share * share * p.covariance + (1 - share) * (1 - share) * q.covariance;
  mean.found = true;
  return mean;
}

bool Agree(const DepthLineParams& params, const PlaneFit& p, const PlaneFit& q) {
  const double tolerance =
      std::max(static_cast<double>(params.side_agreement_px),
               static_cast<double>(params.side_agreement_share) * std::max(p.middle(), q.middle())) +
      2 * std::sqrt(p.covariance(0, 0) + q.covariance(0, 0));
  return std::abs(p.middle() - q.middle()) < tolerance;
}

PlaneFit ChooseSide(const DepthLineParams& params, const PlaneFit& bright, const PlaneFit& dark, LineOwner& owner) {
  owner = LineOwner::kBoth;
  if (bright.found && dark.found && Agree(params, bright, dark)) return Mean(bright, dark);
  const bool choose_bright = bright.found && (!dark.found || bright.middle() > dark.middle());
  owner = choose_bright ? LineOwner::kBright : LineOwner::kDark;
  return choose_bright ? bright : dark;
}

void SetDepth(const DepthLineParams& params, const PlaneFit& fit, const RectifiedCamera& camera, Line3& line) {
  const auto middle = static_cast<double>(params.middle_floor_px), slope = static_cast<double>(params.slope_floor_px);
  const double var_p = fit.covariance(0, 0) + middle * middle;
  const double var_q = fit.covariance(1, 1) + slope * slope;
  const double cov = fit.covariance(0, 1);
  line.disparity_a_px = static_cast<float>(fit.middle() - 0.5 * fit.slope());
  line.disparity_b_px = static_cast<float>(fit.middle() + 0.5 * fit.slope());
  line.var_a = static_cast<float>(var_p + 0.25 * var_q - cov);
  line.var_b = static_cast<float>(var_p + 0.25 * var_q + cov);
  line.cov_ab = static_cast<float>(var_p - 0.25 * var_q);
  PlaceInSpace(camera, line);
}

}  // namespace

void PlaceLines(const DepthLineParams& params, const RectifiedCamera& camera, const DisparityImage& depth,
                const Segments& segments, Lines3& out) {
  out.clear();
  Strip strip;
  for (const Segment2& segment : segments.items) {
    Line3 line;
    line.id = static_cast<std::uint16_t>(out.size());
    line.segment = segment;
    ReadStrip(params, depth, segment, segment.Normal(), strip);
    const PlaneFit bright = FitPlane(params, strip);
    ReadStrip(params, depth, segment, -segment.Normal(), strip);
    const PlaneFit dark = FitPlane(params, strip);
    const PlaneFit fit = ChooseSide(params, bright, dark, line.owner);
    if (fit.found) SetDepth(params, fit, camera, line);
    out.push_back(line);
  }
}

}  // namespace wirepose
