#include "stages/offset_equations.h"

#include <algorithm>

namespace wirepose {
namespace {

double Squared(float x) { return static_cast<double>(x) * static_cast<double>(x); }

// Calls use(begin, end) for the rows of each edge.
template <typename Use>
void ForEachEdge(const OffsetRows& rows, const Use& use) {
  const OffsetRow* begin = rows.begin();
  while (begin != rows.end()) {
    const OffsetRow* end = std::find_if(begin, rows.end(), [&](const OffsetRow& r) { return r.edge != begin->edge; });
    use(begin, end);
    begin = end;
  }
}

}  // namespace

OffsetEquations::Vector8d OffsetEquations::Derivative(const OffsetRow& row) {
  Vector8d d;
  d.head<6>() = row.J.transpose();
  d.tail<2>() = row.image == 0 ? Eigen::Vector2d::Zero() : row.normal.cast<double>().eval();
  return d;
}

// What the samples of an edge share is no news: their mean derivative, shrunk by what is known of the common offset.
OffsetEquations::Vector8d OffsetEquations::SharedDerivative(const OffsetRow* begin, const OffsetRow* end) const {
  Vector8d sum = Vector8d::Zero();
  double weight = 0;
  for (const OffsetRow* row = begin; row != end; ++row) {
    sum += row->weight * Derivative(*row);
    weight += row->weight;
  }
  return sum / (weight + Squared(errors_.noise_px) / Squared(errors_.edge_px));
}

// Both images' errors add up.
double OffsetEquations::ShiftInformation() const {
  const double variance = 2 * Squared(errors_.image_px);
  const double k = 1 / (1 + shift_.squaredNorm() / (4 * variance));
  return UnitVariance() / variance * k * k;
}

double OffsetEquations::UnitVariance() const { return Squared(errors_.noise_px); }

void OffsetEquations::Sum(const OffsetRows& rows, Matrix6d& H, Vector6d& g) {
  Matrix8d N = Matrix8d::Zero();  // lower triangle
  Vector8d b = Vector8d::Zero();
  ForEachEdge(rows, [&](const OffsetRow* begin, const OffsetRow* end) {
    const Vector8d shared = SharedDerivative(begin, end);
    for (const OffsetRow* row = begin; row != end; ++row) {
      const Vector8d d = Derivative(*row);
      const Vector8d pull = row->weight * (d - shared);
      for (int c = 0; c < 8; ++c) {
        for (int i = c; i < 8; ++i) N(i, c) += pull(i) * d(c);
      }
      b += row->residual * pull;
    }
  });
  const double information = ShiftInformation();
  const double xx = N(6, 6) + information, xy = N(7, 6), yy = N(7, 7) + information;
  Eigen::Matrix2d inverse;
  inverse << yy, -xy, -xy, xx;
  inverse /= xx * yy - xy * xy;
  gain_ = inverse * N.block<2, 6>(6, 0);
  free_shift_ = inverse * b.tail<2>();
  for (int c = 0; c < 6; ++c) {
    for (int i = c; i < 6; ++i) H(i, c) = N(i, c) - N(6, i) * gain_(0, c) - N(7, i) * gain_(1, c);
  }
  g = b.head<6>() - gain_.transpose() * b.tail<2>();
}

void OffsetEquations::UpdateShift(const Vector6d& twist) { shift_ = free_shift_ - gain_ * twist; }

Matrix6d OffsetEquations::Spread(const OffsetRows& rows) const {
  Matrix6d samples = Matrix6d::Zero(), edges = Matrix6d::Zero();
  Eigen::Matrix<double, 6, 4> image = Eigen::Matrix<double, 6, 4>::Zero();  // left x, y, right x, y
  double squares = 0, scatter = 0, total = 0;
  ForEachEdge(rows, [&](const OffsetRow* begin, const OffsetRow* end) {
    const Vector8d shared = SharedDerivative(begin, end);
    Vector6d edge = Vector6d::Zero();
    double weight = 0, mean = 0;
    for (const OffsetRow* row = begin; row != end; ++row) {
      const Vector8d pull = row->weight * (Derivative(*row) - shared);
      const Vector6d g = pull.head<6>() - gain_.transpose() * pull.tail<2>();
      samples += g * g.transpose();
      edge += g;
      for (int k = 0; k < 2; ++k) image.col(2 * row->image + k) += static_cast<double>(row->normal[k]) * g;
      weight += row->weight;
      mean += row->weight * row->residual;
      squares += row->weight * row->residual * row->residual;
    }
    if (weight <= 0) return;
    edges += edge * edge.transpose();
    scatter += mean * mean / weight;
    total += weight;
  });
  const double gain = static_cast<double>(errors_.scatter_gain) / std::max(total, 1e-9);
  Matrix6d spread = (Squared(errors_.noise_px) + gain * squares) * samples;
  spread += (Squared(errors_.edge_px) + gain * scatter) * edges;
  spread += Squared(errors_.image_px) * image * image.transpose();
  return spread;
}

}  // namespace wirepose
