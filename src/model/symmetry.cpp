#include "model/symmetry.h"

#include <algorithm>
#include <array>

namespace wirepose {
namespace {

constexpr double kSameExtent = 0.12;      // an extent may change by this share when the box is turned
constexpr float kSamePlace = 0.04F;       // of the diameter: an edge this near to another one lies on it
constexpr float kEnoughWireframe = 0.4F;  // share of the edges' length that a near symmetry keeps

float SquaredDistance(const Vector3& p, const PreparedEdge& e) {
  const float s = std::clamp((p - e.a).dot(e.direction), 0.0F, e.length_m);
  return (p - e.a - s * e.direction).squaredNorm();
}

// Share of the edges' length that the motion carries onto other edges.
float KeptShare(const PreparedModel& model, const Pose& motion) {
  const Matrix3 R = motion.R.cast<float>();
  const Vector3 t = motion.t.cast<float>();
  const float limit = kSamePlace * kSamePlace * model.view.diameter_m * model.view.diameter_m;
  float kept = 0, total = 0;
  for (const PreparedEdge& e : model.edges) {
    const Vector3 a = R * e.a + t, b = R * e.b + t;
    const bool found = std::any_of(model.edges.begin(), model.edges.end(), [&](const PreparedEdge& f) {
      return SquaredDistance(a, f) < limit && SquaredDistance(b, f) < limit;
    });
    total += e.length_m;
    if (found) kept += e.length_m;
  }
  return total > 0 ? kept / total : 0;
}

bool KeepsBox(const PreparedModel& model, const Matrix3d& R) {
  const Vector3d extent = (model.view.box_max_m - model.view.box_min_m).cast<double>();
  const Vector3d turned = R.cwiseAbs() * extent;
  return ((turned - extent).cwiseAbs().array() <= kSameExtent * extent.array()).all();
}

// True when R1 = R2 S for a symmetry S, to within 10 degrees.
bool IsSameTurn(const PreparedModel& model, const Matrix3d& R1, const Matrix3d& R2) {
  constexpr double kTrace = 1 + 2 * 0.985;
  return std::any_of(model.symmetries.begin(), model.symmetries.end(),
                     [&](const Pose& S) { return (R1.transpose() * R2 * S.R).trace() > kTrace; });
}

}  // namespace

std::size_t NearestSymmetry(const PreparedModel& model, const Matrix3d& R, const Matrix3d& R_reference) {
  const Matrix3d turn = R_reference.transpose() * R;
  std::size_t best = 0;
  double best_trace = -4;
  for (std::size_t i = 0; i < model.symmetries.size(); ++i) {
    const double trace = (turn * model.symmetries[i].R).trace();
    if (trace <= best_trace) continue;
    best_trace = trace;
    best = i;
  }
  return best;
}

std::size_t EdgeBeforeSymmetry(const PreparedModel& model, const Pose& symmetry, std::size_t edge) {
  const Pose inverse = symmetry.Inverse();
  const Vector3 a = (inverse * model.edges[edge].a.cast<double>()).cast<float>();
  const Vector3 b = (inverse * model.edges[edge].b.cast<double>()).cast<float>();
  const float limit = 1e-4F * model.view.diameter_m * model.view.diameter_m;
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    const PreparedEdge& f = model.edges[e];
    const float distance = std::min(std::max((a - f.a).squaredNorm(), (b - f.b).squaredNorm()),
                                    std::max((a - f.b).squaredNorm(), (b - f.a).squaredNorm()));
    if (distance < limit) return e;
  }
  return edge;
}

Matrix3d CanonicalOrientation() {
  // Upright (model z against camera y), seen from 25 degrees above, turned by 20 degrees, rolled by 4.
  Matrix3d R;
  R << 0.947, -0.313, 0.063, -0.079, -0.420, -0.904, 0.310, 0.852, -0.423;
  return R;
}

Matrix3d BoxTurn(std::size_t k) {
  constexpr std::array<std::array<int, 3>, 6> kOrders = {
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  const std::array<int, 3>& order = kOrders[k / 4 % 6];
  // The first three orders are even permutations; the third sign makes the determinant 1.
  const double parity = k / 4 < 3 ? 1 : -1;
  const double s0 = (k & 1U) != 0 ? -1 : 1, s1 = (k & 2U) != 0 ? -1 : 1;
  Matrix3d R = Matrix3d::Zero();
  R(order[0], 0) = s0;
  R(order[1], 1) = s1;
  R(order[2], 2) = parity * s0 * s1;
  return R;
}

Pose TurnedModel(const PreparedModel& model, std::size_t k) {
  const Vector3d centre = model.centre.cast<double>();
  const Matrix3d R = BoxTurn(k);
  return {R, centre - R * centre};
}

NearTurns FindNearTurns(const PreparedModel& model) {
  struct Turn {
    float kept;
    std::uint8_t index;
  };
  FixedVector<Turn, kBoxTurns> turns;
  for (std::size_t k = 1; k < kBoxTurns; ++k) {
    const Matrix3d R = BoxTurn(k);
    if (!KeepsBox(model, R) || IsSameTurn(model, R, Matrix3d::Identity())) continue;
    const bool known = std::any_of(turns.begin(), turns.end(),
                                   [&](const Turn& turn) { return IsSameTurn(model, R, BoxTurn(turn.index)); });
    if (known) continue;
    const float kept = KeptShare(model, TurnedModel(model, k));
    if (kept >= kEnoughWireframe) turns.push_back({kept, static_cast<std::uint8_t>(k)});
  }
  std::sort(turns.begin(), turns.end(),
            [](const Turn& p, const Turn& q) { return p.kept != q.kept ? p.kept > q.kept : p.index < q.index; });
  NearTurns near;
  for (const Turn& turn : turns) {
    if (!near.try_push_back(turn.index)) break;
  }
  return near;
}

}  // namespace wirepose
