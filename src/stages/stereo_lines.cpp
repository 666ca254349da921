#include "stages/stereo_lines.h"

#include <algorithm>
#include <cmath>

#include "stages/strip_search.h"

namespace wirepose {
namespace {

// Where the right image's gradient along x peaks with the left edge's polarity, nearest to x; negative when nowhere.
float FindEdgeInRow(const SmoothPlane& smooth, int y, float x, float reach, int sign, int width) {
  const std::int16_t* row = smooth.data() + y * kStride;
  const auto gradient = [&](int i) { return sign * (row[i + 1] - row[i - 1]); };
  const int i0 = std::max(2, static_cast<int>(std::ceil(x - reach)));
  const int i1 = std::min(width - 3, static_cast<int>(std::floor(x + reach)));
  float best = -1, nearest = reach + 1;
  for (int i = i0; i <= i1; ++i) {
    const int here = gradient(i);
    if (here < kGradientOne / 2) continue;
    const int before = gradient(i - 1);
    const int after = gradient(i + 1);
    if (here < before || here <= after) continue;
    const auto bend = static_cast<float>(before - 2 * here + after);
    const float at = static_cast<float>(i) + 0.5F * static_cast<float>(before - after) / bend;
    if (std::abs(at - x) >= nearest) continue;
    nearest = std::abs(at - x);
    best = at;
  }
  return best;
}

// Weighted straight line d(t) = p + q (t - 1/2).
struct DisparityFit {
  double p = 0, q = 0;
  double h00 = 0, h01 = 0, h11 = 0;  // normal matrix of (p, q)
  double residual = 0;               // robust sigma, px
  double weight = 0;                 // sum of weights: rows that agree
};

struct DisparitySample {
  float t, d;
};
using DisparitySamples = FixedVector<DisparitySample, kMaxImageHeight>;

// Iteratively reweighted (Geman-McClure, scale 0.5 px) least squares, started at the coarse match.
DisparityFit FitDisparity(const DisparitySamples& samples, const StripMatch& start) {
  DisparityFit fit;
  fit.p = 0.5 * static_cast<double>(start.disparity_a + start.disparity_b);
  fit.q = static_cast<double>(start.disparity_b - start.disparity_a);
  for (int iteration = 0; iteration < 6; ++iteration) {
    const double scale = iteration < 2 ? 1.0 : 0.5;
    double h00 = 0, h01 = 0, h11 = 0, g0 = 0, g1 = 0, sum = 0;
    for (const DisparitySample& s : samples) {
      const double u = static_cast<double>(s.t) - 0.5;
      const double e = static_cast<double>(s.d) - fit.p - fit.q * u;
      const double k = 1 / (1 + e * e / (scale * scale));
      const double w = k * k;
      h00 += w;
      h01 += w * u;
      h11 += w * u * u;
      g0 += w * e;
      g1 += w * u * e;
      sum += w * e * e;
    }
    // The prior keeps the slope where the rows do not tell it: half a pixel over the line.
    const double regularised = h11 + 0.02;
    const double det = h00 * regularised - h01 * h01;
    if (det < 1e-9) break;
    fit.p += (regularised * g0 - h01 * g1) / det;
    fit.q += (h00 * g1 - h01 * g0) / det;
    fit.h00 = h00;
    fit.h01 = h01;
    fit.h11 = h11;
    fit.weight = h00;
    fit.residual = std::sqrt(sum / std::max(h00, 1e-9));
  }
  return fit;
}

// Takes the match as it is, with the given standard deviation at each end.
void SetCoarse(float sigma_px, const StripMatch& match, Line3& line) {
  line.disparity_a_px = match.disparity_a;
  line.disparity_b_px = match.disparity_b;
  line.var_a = line.var_b = sigma_px * sigma_px;
  line.cov_ab = 0;
}

// Replaces the coarse match by the edge's own position in the right image, with covariance.
void Refine(const StereoLineParams& params, const StereoInput& in, const StripMatch& match, Line3& line) {
  const RowSamples rows = CrossedRows(line.segment, kMaxImageHeight);
  const int sign = line.segment.Normal().x() > 0 ? 1 : -1;  // the normal points to the brighter side
  DisparitySamples samples;
  for (const RowSample& row : rows) {
    const float d = match.disparity_a + row.t * (match.disparity_b - match.disparity_a);
    const float x = FindEdgeInRow(in.right_smooth, row.y, row.x - d, params.search_px, sign, in.camera.width);
    if (x >= 0) samples.push_back({row.t, row.x - x});
  }
  const double sigma_offset = static_cast<double>(line.segment.sigma_offset_px);
  double p = 0.5 * static_cast<double>(match.disparity_a + match.disparity_b);
  double q = static_cast<double>(match.disparity_b - match.disparity_a);
  double var_p = static_cast<double>(params.coarse_sigma_px * params.coarse_sigma_px), var_q = 4 * var_p, cov = 0;
  const DisparityFit fit = FitDisparity(samples, match);
  const auto n = static_cast<double>(rows.size());
  if (fit.weight >= static_cast<double>(params.min_support) * n && fit.weight >= 5) {
    p = fit.p;
    q = fit.q;
    const double sigma = static_cast<double>(params.sigma_inflation) * std::max(fit.residual, 0.05);
    const double det = fit.h00 * fit.h11 - fit.h01 * fit.h01;
    const double floor =
        static_cast<double>(params.sigma_floor_px * params.sigma_floor_px) + sigma_offset * sigma_offset;
    var_p = sigma * sigma * fit.h11 / std::max(det, 1e-9) + floor;
    var_q = sigma * sigma * fit.h00 / std::max(det, 1e-9) + 4 * floor;
    cov = -sigma * sigma * fit.h01 / std::max(det, 1e-9);
  }
  line.disparity_a_px = static_cast<float>(p - 0.5 * q);
  line.disparity_b_px = static_cast<float>(p + 0.5 * q);
  line.var_a = static_cast<float>(var_p + 0.25 * var_q - cov);
  line.var_b = static_cast<float>(var_p + 0.25 * var_q + cov);
  line.cov_ab = static_cast<float>(var_p - 0.25 * var_q);
}

// Which side the depth belongs to; false when neither side's match can be trusted.
bool ChooseSide(const StereoLineParams& params, const StripMatch& bright, const StripMatch& dark, float max_ratio,
                StripMatch& out, LineOwner& owner) {
  const auto middle = [](const StripMatch& m) { return 0.5F * (m.disparity_a + m.disparity_b); };
  if (bright.found && dark.found && std::abs(middle(bright) - middle(dark)) < params.side_agreement_px + 0.5F &&
      std::min(bright.cost_ratio, dark.cost_ratio) < 0.2F + max_ratio) {
    out = bright.cost_ratio <= dark.cost_ratio ? bright : dark;
    owner = LineOwner::kBoth;
    return true;
  }
  const bool choose_bright = bright.found && (!dark.found || bright.cost_ratio <= dark.cost_ratio);
  out = choose_bright ? bright : dark;
  owner = choose_bright ? LineOwner::kBright : LineOwner::kDark;
  return out.found && out.cost_ratio < max_ratio;
}

void MatchLine(const StereoLineParams& params, const StereoInput& in, StereoScratch& scratch, Line3& line) {
  const bool flat = std::abs(line.segment.Delta().y()) < params.min_slope * line.segment.Length();
  StripMatch bright, dark, match;
  (flat ? MatchFlat : MatchSteep)(params, in, line.segment, scratch, bright, dark);
  const float max_ratio = flat ? params.max_flat_cost_ratio : params.max_cost_ratio;
  if (!ChooseSide(params, bright, dark, max_ratio, match, line.owner)) return;
  if (flat) {
    SetCoarse(params.flat_sigma_px, match, line);
  } else {
    Refine(params, in, match, line);
  }
  PlaceInSpace(in.camera, line);
}

}  // namespace

void MatchLines(const StereoLineParams& params, const StereoInput& input, const Segments& segments,
                StereoScratch& scratch, Lines3& out) {
  out.clear();
  for (const Segment2& segment : segments.items) {
    Line3 line;
    line.id = static_cast<std::uint16_t>(out.size());
    line.segment = segment;
    MatchLine(params, input, scratch, line);
    out.push_back(line);
  }
}

}  // namespace wirepose
