#include "pipeline/row_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace wirepose {
namespace {

constexpr double kCornerSigma_px = 0.2;      // of one corner, to weigh it against what motions are usual
constexpr double kUsualTurn_rad = 0.02;      // of an eye against the calibration: 10 px at f 500 px
constexpr double kUsualShift_m = 0.02;       // 1 m/s for 20 ms
constexpr double kMemory = 1 - 1.0 / 128;    // weight of a frame against the next one
constexpr std::uint32_t kForgetAfter = 150;  // frames without corners: what was seen before says nothing any more
constexpr double kMinAgreeing = 0.5;         // share of the corners that the motion must explain

// Middle one of the values, which are put in another order.
template <typename T>
T Median(std::span<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

float Root(double power) { return static_cast<float>(std::sqrt(std::max(0.0, power))); }

}  // namespace

AlignmentMonitor::Vector5 AlignmentMonitor::Normal::Solve() const {
  // What is usual keeps the numbers finite where the corners do not tell them apart.
  Matrix5 A = H;
  const double turn = kCornerSigma_px / kUsualTurn_rad, shift = kCornerSigma_px / kUsualShift_m;
  for (Eigen::Index i = 0; i < 5; ++i) A(i, i) += i < 3 ? turn * turn : shift * shift;
  return A.ldlt().solve(g);
}

AlignmentMonitor::Vector5 AlignmentMonitor::Slope(const RectifiedCamera& camera, const RowOffset& o) {
  const double d = static_cast<double>(o.disparity_px);
  const double x = (static_cast<double>(o.x_px) - d - camera.cx) / camera.f;
  const double y = (static_cast<double>(o.y_px) - camera.cy) / camera.f;
  const double nearness = d / camera.baseline;
  Vector5 slope;
  slope << camera.f * (1 + y * y), -camera.f * x * y, -camera.f * x, -nearness, y * nearness;
  return slope;
}

bool AlignmentMonitor::Fit(const RectifiedCamera& camera, std::span<const RowOffset> offsets, Normal& normal,
                           Vector5& motion, double& noise_power) {
  // Iteratively reweighted (Geman-McClure), from a scale at which no corner is far to that of good corners.
  constexpr double kScales_px[] = {4, 4, 2, 2, 1, 1, 0.5, 0.5, 0.5};
  motion.setZero();
  double residual = 0;
  for (const double scale : kScales_px) {
    normal = {};
    residual = 0;
    for (const RowOffset& offset : offsets) {
      const Vector5 slope = Slope(camera, offset);
      const double v = static_cast<double>(offset.offset_px);
      const double e = v - slope.dot(motion);
      const double k = 1 / (1 + e * e / (scale * scale));
      const double w = k * k;
      normal.H += w * slope * slope.transpose();
      normal.g += w * v * slope;
      normal.weight += w;
      residual += w * e * e;
    }
    motion = normal.Solve();
  }
  const double agreeing = normal.weight;
  if (agreeing < static_cast<double>(kMinCorners) || agreeing < kMinAgreeing * static_cast<double>(offsets.size())) {
    return false;
  }
  noise_power = 5 * (residual / (agreeing - 5)) / agreeing;
  return true;
}

void AlignmentMonitor::DescribeFrame(std::span<const RowOffset> offsets) {
  alignment_.corners = static_cast<std::uint32_t>(offsets.size());
  alignment_.median_px = alignment_.spread_px = 0;
  if (offsets.empty()) return;
  std::array<float, kMaxRowOffsets> values;
  const std::size_t count = std::min(offsets.size(), kMaxRowOffsets);
  for (std::size_t i = 0; i < count; ++i) values[i] = offsets[i].offset_px;
  const std::span<float> used(values.data(), count);
  alignment_.median_px = Median(used);
  for (float& v : used) v = std::abs(v - alignment_.median_px);
  alignment_.spread_px = 1.48F * Median(used);
}

void AlignmentMonitor::Update(const RectifiedCamera& camera, std::span<const RowOffset> offsets) {
  DescribeFrame(offsets);
  Normal normal;
  Vector5 motion;
  double noise_power = 0;
  if (offsets.size() < kMinCorners || !Fit(camera, offsets, normal, motion, noise_power)) {
    if (++frames_without_ >= kForgetAfter) {
      const RowAlignment frame = alignment_;
      *this = {};
      alignment_.corners = frame.corners;
      alignment_.median_px = frame.median_px;
      alignment_.spread_px = frame.spread_px;
    }
    return;
  }
  frames_without_ = 0;
  AddToSteady(normal, motion);
  const Vector5 steady = steady_.Solve();
  varying_[frames_ % kRecent] = normal.Power(motion - steady) - noise_power;
  frames_ += frames_ < std::numeric_limits<std::uint32_t>::max() ? 1 : 0;
  // Corners of a scene that stands still err alike in every frame: the noise of one frame, not of their mean.
  noise_power_ += (noise_power - noise_power_) / std::min(128.0, static_cast<double>(frames_));
  alignment_.steady_px = Root(steady_.Power(steady) - noise_power_);
  std::array<double, kRecent> varying = varying_;
  alignment_.varying_px = Root(Median(std::span<double>(varying)));
  Judge();
}

void AlignmentMonitor::AddToSteady(const Normal& frame, const Vector5& motion) {
  // What is far from all before may be a wild frame, or the beginning of something new: it counts, but less.
  constexpr double kNear_px = 2 * static_cast<double>(kLimit_px);
  double share = 1;
  if (steady_.weight > 0) {
    const double distance = std::sqrt(std::max(0.0, frame.Power(motion - steady_.Solve())));
    if (distance > kNear_px) share = kNear_px / distance;
  }
  steady_.H = kMemory * steady_.H + share * frame.H;
  steady_.g = kMemory * steady_.g + share * frame.g;
  steady_.weight = kMemory * steady_.weight + share * frame.weight;
}

void AlignmentMonitor::Judge() {
  const bool alarmed = alignment_.state == RowState::kSteadyOffset || alignment_.state == RowState::kVaryingOffset;
  const float worst = std::max(alignment_.steady_px, alignment_.varying_px);
  if (frames_ < kMinFrames) {
    alignment_.state = RowState::kUnknown;
  } else if (worst <= (alarmed ? kCalm_px : kLimit_px)) {
    alignment_.state = RowState::kAligned;
  } else {
    const bool is_steady = alignment_.steady_px >= alignment_.varying_px;
    alignment_.state = is_steady ? RowState::kSteadyOffset : RowState::kVaryingOffset;
  }
}

}  // namespace wirepose
