#include "stages/refinement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "stages/edge_profile.h"

namespace wirepose {
namespace {

// Signed distance along `normal` to the most plausible edge near `p`: strong and close. False when there is none.
bool FindEdge(const SmoothPlane& plane, int width, int height, const Vector2& p, const Vector2& normal, int range,
              float min_gradient, float& offset) {
  EdgeProfile profile;
  if (!profile.Read(plane, width, height, p, normal, range)) return false;
  const float threshold = min_gradient * kGradientOne;
  float best = 0;
  profile.ForEachPeak(threshold, [&](const EdgePeak& peak) {
    // Strength saturates: beyond some contrast nearness decides.
    const float score = std::min(std::abs(peak.gradient), 8.0F * threshold) *
                        (1 - 0.7F * std::abs(peak.offset_px) / static_cast<float>(range + 1));
    if (score <= best) return;
    best = score;
    offset = peak.offset_px;
  });
  return best > 0;
}

class Refiner {
 public:
  Refiner(const RefineParams& params, const SceneImages& images, const PreparedModel& model, RefineScratch& scratch)
      : params_(params), images_(images), model_(model), scratch_(scratch), equations_(params.errors) {}

  void Run(const Pose& start, RefinedPose& out) {
    Pose T = start;
    out = {};
    out.T_camera_model = start;
    for (int i = 0; i < params_.iterations; ++i) {
      if (i == 0 || i == params_.iterations / 2) Sample(T);
      const float share = static_cast<float>(i) / static_cast<float>(std::max(1, params_.iterations - 1));
      // Halves early: the first iterations bring most edges close.
      const float range = params_.first_range_px + (params_.last_range_px - params_.first_range_px) * std::sqrt(share);
      const bool last = 3 * i >= 2 * params_.iterations;
      Measure(T, std::clamp(static_cast<int>(range + 0.5F), 2, EdgeProfile::kMaxRange));
      if (last) DropUnqualified();
      Vector6d twist;
      if (rows_.size() < 12 || !Solve(twist)) return;
      T = PerturbLeft(T, twist, T.t);
      if (!(T.t.z() > 0.05) || !twist.allFinite()) return;
      if (last && twist.head<3>().norm() < 1e-4 && twist.tail<3>().norm() < 1e-5 * T.t.z()) break;
    }
    Finish(T, out);
  }

 private:
  void Sample(const Pose& T) {
    SampleVisibleEdges(params_.samples, images_.camera, model_, T, scratch_.front, scratch_.samples);
    scratch_.surface_samples.clear();
    if (images_.surface == nullptr) return;
    SampleSurface(params_.surface, images_.camera, model_, T, scratch_.samples, scratch_.front,
                  scratch_.surface_samples);
  }

  void Measure(const Pose& T, int range) {
    scratch_.surface_rows.clear();
    if (images_.surface != nullptr) {
      MeasureSurface(params_.surface, images_.camera, model_, T, *images_.surface, scratch_.surface_samples,
                     scratch_.surface_rows);
    }
    rows_.clear();
    found_.fill(0);
    sampled_.fill(0);
    for (const EdgeSample& s : scratch_.samples) {
      const Vector3d p = T.R * s.point.cast<double>();
      const Vector3d x = p + T.t;
      MeasureIn(images_.left, 0, s.tangent, p, x, range, s.edge);
      if (!images_.camera.has_right_image) continue;
      MeasureIn(images_.right, images_.camera.baseline, s.tangent_right, p, x, range, s.edge);
    }
  }

  // `shift`: how far the camera stands to the right of the left one, m.
  void MeasureIn(const SmoothPlane& plane, double shift, const Vector2& tangent, const Vector3d& p, const Vector3d& x,
                 int range, std::uint16_t edge) {
    const RectifiedCamera& c = images_.camera;
    const double iz = 1 / x.z();
    const Vector2 at(static_cast<float>(c.f * (x.x() - shift) * iz + c.cx),
                     static_cast<float>(c.f * x.y() * iz + c.cy));
    if (!(at.x() > 2 && at.y() > 2 && at.x() < static_cast<float>(c.width - 3) &&
          at.y() < static_cast<float>(c.height - 3)))
      return;
    ++sampled_[edge];
    const Vector2 normal(-tangent.y(), tangent.x());
    float offset = 0;
    if (!FindEdge(plane, c.width, c.height, at, normal, range, params_.min_gradient, offset)) return;
    OffsetRow row;
    const auto nx = static_cast<double>(normal.x()), ny = static_cast<double>(normal.y());
    // d(n . u)/dx of the point, then d(point)/d(twist) = [-[p]x, I] for a rotation about the model origin.
    const Vector3d g(nx * c.f * iz, ny * c.f * iz, -(nx * c.f * (x.x() - shift) + ny * c.f * x.y()) * iz * iz);
    row.J.head<3>() = p.cross(g).transpose();
    row.J.tail<3>() = g.transpose();
    row.residual = static_cast<double>(offset);
    row.edge = edge;
    row.image = shift > 0 ? 1 : 0;
    row.normal = normal;
    rows_.push_back(row);
    ++found_[edge];
  }

  void DropUnqualified() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const std::uint16_t e = rows_[i].edge;
      if (static_cast<float>(found_[e]) >= params_.min_qualified_share * static_cast<float>(sampled_[e]))
        rows_[kept++] = rows_[i];
    }
    rows_.resize(kept);
  }

  // Robust scale: 1.48 times the median absolute residual.
  double Scale() {
    std::array<float, 2 * kMaxEdgeSamples> magnitude{};
    const std::size_t n = rows_.size();
    for (std::size_t i = 0; i < n; ++i) magnitude[i] = static_cast<float>(std::abs(rows_[i].residual));
    const auto middle = magnitude.begin() + static_cast<std::ptrdiff_t>(n / 2);
    std::nth_element(magnitude.begin(), middle, magnitude.begin() + static_cast<std::ptrdiff_t>(n));
    return std::max(static_cast<double>(params_.sigma_floor_px), 1.4826 * static_cast<double>(*middle));
  }

  // Geman-McClure.
  void Weigh() {
    sigma_ = Scale();
    for (OffsetRow& row : rows_) {
      const double r = row.residual / (2 * sigma_);
      const double k = 1 / (1 + r * r);
      row.weight = k * k;
    }
  }

  bool Solve(Vector6d& twist) {
    Weigh();
    Vector6d g;
    equations_.Sum(rows_, H_, g);
    AddSurface(scratch_.surface_rows, equations_.UnitVariance(), H_, g);
    // Levenberg damping: a thousandth of the mean information, so that what the edges do not tell stays put.
    Matrix6d damped = H_;
    for (int i = 0; i < 6; ++i) damped(i, i) *= 1.001;
    const Eigen::LDLT<Matrix6d> ldlt(damped);
    if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 1e-9)) return false;
    twist = ldlt.solve(g);
    // A step beyond 0.2 rad or a fifth of the distance has left what one linearisation can say.
    const double size = std::max(twist.head<3>().norm() / 0.2, twist.tail<3>().norm() / 0.2);
    if (size > 1) twist /= size;
    equations_.UpdateShift(twist);
    return true;
  }

  void Finish(const Pose& T, RefinedPose& out) {
    out.T_camera_model = T;
    double sum = 0, weight = 0;
    std::uint32_t inliers = 0;
    for (const OffsetRow& row : rows_) {
      sum += row.weight * row.residual * row.residual;
      weight += row.weight;
      if (std::abs(row.residual) < 3 * sigma_) ++inliers;
    }
    const Eigen::LDLT<Matrix6d> ldlt(H_);
    if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 1e-9) || weight < 6) return;
    Matrix6d spread = equations_.Spread(rows_);
    if (!scratch_.surface_rows.empty())
      spread += SpreadOfSurface(params_.surface, scratch_.surface_rows, equations_.UnitVariance());
    // Column by column: Eigen solves for a whole matrix by blocks, on the heap where it cannot prove them small.
    Matrix6d half;
    for (int i = 0; i < 6; ++i) half.col(i) = ldlt.solve(Vector6d(spread.col(i)));
    half.transposeInPlace();
    for (int i = 0; i < 6; ++i) out.covariance.col(i) = ldlt.solve(Vector6d(half.col(i)));
    out.covariance = (0.5 * (out.covariance + out.covariance.transpose())).eval();
    double information = 0;  // trace of the position's part of the inverse
    for (int i = 3; i < 6; ++i) information += ldlt.solve(Vector6d(Vector6d::Unit(i)))(i);
    out.position_sigma_m = static_cast<float>(sigma_ * std::sqrt(information));
    out.rms_px = static_cast<float>(std::sqrt(sum / weight));
    out.inliers = static_cast<std::uint16_t>(inliers);
    out.shift_px = static_cast<float>(equations_.shift().norm());
    out.ok = out.rms_px < params_.max_rms_px && out.covariance.allFinite();
  }

  const RefineParams& params_;
  const SceneImages& images_;
  const PreparedModel& model_;
  RefineScratch& scratch_;
  OffsetRows rows_;
  std::array<std::uint16_t, kMaxModelEdges> found_{}, sampled_{};
  OffsetEquations equations_;
  Matrix6d H_ = Matrix6d::Zero();  // its lower triangle: all that LDLT reads
  double sigma_ = 1;
};

}  // namespace

void RefinePose(const RefineParams& params, const SceneImages& images, const PreparedModel& model, const Pose& start,
                RefineScratch& scratch, RefinedPose& out) {
  Refiner(params, images, model, scratch).Run(start, out);
}

}  // namespace wirepose
