#include "stages/promotion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/simd.h"
#include "stages/overrun.h"

namespace wirepose {
namespace {

// Lines looked at in one go: where none of them is marked, as almost everywhere, all are passed over.
constexpr std::size_t kLineBlock = 8;
static_assert(kMaxSegments % kLineBlock == 0);

// The lines' image ends, number by number.
struct SegmentEnds {
  std::array<float, kMaxSegments> ax, ay, bx, by;
};

// Marks the segments whose ends both lie within `max_offset` of the line through `origin` along the unit vector
// `direction`.
WIREPOSE_VECTOR_KERNEL void MarkNear(const SegmentEnds& ends, std::size_t count, const Vector2& origin,
                                     const Vector2& direction, float max_offset, std::uint8_t* near) {
  const float px = origin.x(), py = origin.y(), ux = direction.x(), uy = direction.y();
  for (std::size_t i = 0; i < count; ++i) {
    const float a = std::abs((ends.ax[i] - px) * uy - (ends.ay[i] - py) * ux);
    const float b = std::abs((ends.bx[i] - px) * uy - (ends.by[i] - py) * ux);
    const float farther = a > b ? a : b;
    near[i] = farther <= max_offset ? 1 : 0;
  }
}

class Promoter {
 public:
  Promoter(const PromotionParams& params, const PoseScorer& scorer, const RectifiedCamera& camera,
           const PreparedModel& model, const Lines3& lines)
      : params_(params), scorer_(scorer), camera_(camera), model_(model), lines_(lines) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Segment2& s = lines[i].segment;
      ends_.ax[i] = s.a.x(), ends_.ay[i] = s.a.y(), ends_.bx[i] = s.b.x(), ends_.by[i] = s.b.y();
    }
  }

  // False when the aligned pose fails.
  bool Promote(const Hypothesis& hypothesis, CorrespondingSet& set) {
    set = {};
    set.R = hypothesis.R;
    set.t = hypothesis.t;
    for (const float share : {1.0F, 0.5F}) {
      Gather(set, share * params_.max_offset_px);
      if (!Align(set)) return false;
    }
    const EdgeBits visible = Visible(set);
    PoseSupport support;
    if (!scorer_.Score(set.R, set.t, visible, support)) return false;
    set.score = support.score;
    set.strength = set.score + params_.line_gain * static_cast<float>(set.line_count) +
                   params_.face_gain * static_cast<float>(set.face_count);
    GatherEvidence(visible, support, set);
    return true;
  }

 private:
  struct Found {
    SetMember member;
    float length_px;
  };

  [[nodiscard]] EdgeBits Visible(const CorrespondingSet& set) const {
    return model_.VisibleEdges(-(set.R.transpose() * set.t));
  }

  // All lines along visible edges; the longest line of each edge counts it.
  void Gather(CorrespondingSet& set, float max_offset) {
    found_.clear();
    set.members.clear();
    set.line_count = set.face_count = 0;
    const EdgeBits visible = Visible(set);
    std::array<bool, kMaxModelFaces> covered{};
    for (std::size_t e = NextEdge(visible, 0); e < model_.edges.size(); e = NextEdge(visible, e + 1)) {
      PoseScorer::Projected p;
      if (!scorer_.Project(model_.edges[e], set.R, set.t, p)) continue;
      if (!GatherEdge(e, p, max_offset)) continue;
      ++set.line_count;
      for (const std::uint16_t face : model_.view.edges[e].face) {
        if (face == kNoFace || covered[face]) continue;
        covered[face] = true;
        if (FacesCamera(set, face)) ++set.face_count;
      }
    }
    std::sort(found_.begin(), found_.end(), [](const Found& p, const Found& q) {
      return p.length_px != q.length_px ? p.length_px > q.length_px : p.member.edge < q.member.edge;
    });
    for (const Found& f : found_) {
      if (!set.members.try_push_back(f.member)) break;
    }
  }

  bool GatherEdge(std::size_t e, const PoseScorer::Projected& p, float max_offset) {
    const Vector2 d = p.b - p.a;
    const float length = d.norm();
    if (length < 6) return false;
    const Vector2 u = d / length;
    const Line3* best = nullptr;
    float best_overlap = 4;
    const std::size_t count = lines_.size();
    MarkNear(ends_, count, p.a, u, max_offset, near_.data());
    for (std::size_t i = 0; i < count; ++i) {
      while (i % kLineBlock == 0 && i + kLineBlock < count && NoneNear(i)) i += kLineBlock;
      if (near_[i] == 0) continue;
      const Line3& line = lines_[i];
      const Segment2& s = line.segment;
      const float across_a = std::abs((s.a - p.a).x() * u.y() - (s.a - p.a).y() * u.x());
      const float across_b = std::abs((s.b - p.a).x() * u.y() - (s.b - p.a).y() * u.x());
      const float s0 = (s.a - p.a).dot(u), s1 = (s.b - p.a).dot(u);
      if (std::abs(s1 - s0) < params_.min_cosine * s.Length()) continue;
      const float overlap = std::min(length, std::max(s0, s1)) - std::max(0.0F, std::min(s0, s1));
      if (overlap < 0.6F * std::abs(s1 - s0)) continue;
      if (line.has_depth && !DepthAgrees(line, p, s0 / length, s1 / length)) continue;
      const float merit = overlap - 2 * (across_a + across_b);
      if (merit <= best_overlap) continue;
      best_overlap = merit;
      best = &line;
    }
    if (best == nullptr) return false;
    const Found found{{best->id, static_cast<std::uint16_t>(e)}, best->segment.Length()};
    found_.push_back(found);  // at most one an edge
    return true;
  }

  void GatherEvidence(const EdgeBits& visible, const PoseSupport& support, CorrespondingSet& set) const {
    SetEvidence& e = set.evidence;
    e.score = support.score;
    e.left = support.left;
    e.right = support.right;
    e.edges = static_cast<float>(support.edges);
    e.lines = set.line_count;
    e.overrun =
        MeasureOverrun(camera_, scorer_.scene().left, model_, {set.R.cast<double>(), set.t.cast<double>()}, visible)
            .share;
    float length = 0, deep = 0, residual = 0, misfit = 0;
    for (const Found& f : found_) {
      PoseScorer::Projected p;
      if (!scorer_.Project(model_.edges[f.member.edge], set.R, set.t, p)) continue;
      const Line3& line = lines_[f.member.line];
      length += f.length_px;
      residual += f.length_px * Residual(line.segment, p);
      if (!line.has_depth) continue;
      deep += f.length_px;
      misfit += f.length_px * DisparityMisfit(line, p);
    }
    // One pixel more, so that nothing is divided by zero.
    e.residual_px = residual / (length + 1);
    e.disparity_misfit = misfit / (deep + 1);
    e.depth_share = deep / (VisibleLength(set, visible) + 1);
  }

  // Mean distance of the segment's ends from the edge.
  static float Residual(const Segment2& s, const PoseScorer::Projected& p) {
    const Vector2 d = p.b - p.a;
    const auto across = [&](const Vector2& q) { return std::abs((q - p.a).x() * d.y() - (q - p.a).y() * d.x()); };
    return 0.5F * (across(s.a) + across(s.b)) / std::max(1.0F, d.norm());
  }

  // Difference of the disparities at the line's middle, in its standard deviations.
  static float DisparityMisfit(const Line3& line, const PoseScorer::Projected& p) {
    constexpr float kFloorPx2 = 0.09F;
    const Vector2 d = p.b - p.a;
    const float along = (line.segment.Middle() - p.a).dot(d) / std::max(1.0F, d.squaredNorm());
    const float expected = p.disparity_a + along * (p.disparity_b - p.disparity_a);
    const float measured = 0.5F * (line.disparity_a_px + line.disparity_b_px);
    return std::abs(measured - expected) / std::sqrt(MiddleVariance(line) + kFloorPx2);
  }

  // Of the disparity in the middle of a line, px^2.
  static float MiddleVariance(const Line3& line) { return 0.25F * (line.var_a + line.var_b + 2 * line.cov_ab); }

  [[nodiscard]] float VisibleLength(const CorrespondingSet& set, const EdgeBits& visible) const {
    float length = 0;
    for (std::size_t e = NextEdge(visible, 0); e < model_.edges.size(); e = NextEdge(visible, e + 1)) {
      PoseScorer::Projected p;
      if (scorer_.Project(model_.edges[e], set.R, set.t, p)) length += (p.b - p.a).norm();
    }
    return length;
  }

  [[nodiscard]] bool NoneNear(std::size_t block) const {
    std::uint64_t marks;
    static_assert(sizeof(marks) == kLineBlock);
    std::memcpy(&marks, near_.data() + block, kLineBlock);
    return marks == 0;
  }

  // The line's disparity at its middle is within five sigma (and 4 px) of the edge's there.
  [[nodiscard]] bool DepthAgrees(const Line3& line, const PoseScorer::Projected& p, float s0, float s1) const {
    const float middle = 0.5F * (s0 + s1);
    const float expected = p.disparity_a + middle * (p.disparity_b - p.disparity_a);
    const float measured = 0.5F * (line.disparity_a_px + line.disparity_b_px);
    return std::abs(expected - measured) < 4 + 5 * std::sqrt(MiddleVariance(line));
  }

  [[nodiscard]] bool FacesCamera(const CorrespondingSet& set, std::uint16_t f) const {
    return IsTowards(model_.view.faces[f], -(set.R.transpose() * set.t));
  }

  // One Gauss-Newton step on all members: at both ends of each line the offset from the projected edge and, with depth,
  // the difference of disparity. A weak prior keeps undetermined motions in place.
  bool Align(CorrespondingSet& set) const {
    Matrix6d H = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
    // 3 degrees and 3 % of the distance.
    const double distance = static_cast<double>(set.t.norm());
    for (int i = 0; i < 6; ++i) H(i, i) = i < 3 ? 1 / (0.05 * 0.05) : 1 / (0.03 * 0.03 * distance * distance);
    for (const Found& f : found_) AddLine(set, lines_[f.member.line], model_.edges[f.member.edge], H, g);
    const Eigen::LDLT<Matrix6d> ldlt(H);
    if (ldlt.info() != Eigen::Success) return false;
    const Vector6d twist = ldlt.solve(g);
    if (!twist.allFinite()) return false;
    const Pose T = PerturbLeft({set.R.cast<double>(), set.t.cast<double>()}, twist, set.t.cast<double>());
    set.R = T.R.cast<float>();
    set.t = T.t.cast<float>();
    return set.t.z() > 0.05F;
  }

  void AddLine(const CorrespondingSet& set, const Line3& line, const PreparedEdge& edge, Matrix6d& H,
               Vector6d& g) const {
    PoseScorer::Projected p;
    if (!scorer_.Project(edge, set.R, set.t, p)) return;
    const Vector2 d = p.b - p.a;
    const float length_squared = std::max(d.squaredNorm(), 1.0F);
    const Vector2 n = Vector2(-d.y(), d.x()) / std::sqrt(length_squared);
    const float za = static_cast<float>(camera_.f * camera_.baseline) / p.disparity_a;
    const float zb = static_cast<float>(camera_.f * camera_.baseline) / p.disparity_b;
    for (int end = 0; end < 2; ++end) {
      const Vector2 q = end == 0 ? line.segment.a : line.segment.b;
      const float s = std::clamp((q - p.a).dot(d) / length_squared, -0.2F, 1.2F);
      const float w = s * za / (s * za + (1 - s) * zb);  // the same point along the edge in space
      const Vector3d x = (set.R * (edge.a + w * (edge.b - edge.a)) + set.t).cast<double>();
      if (x.z() < 0.05) continue;
      const double iz = 1 / x.z();
      const auto nx = static_cast<double>(n.x()), ny = static_cast<double>(n.y());
      const Vector3d gradient(nx * camera_.f * iz, ny * camera_.f * iz,
                              -(nx * camera_.f * x.x() + ny * camera_.f * x.y()) * iz * iz);
      const auto offset = static_cast<double>((q - (p.a + s * d)).dot(n));
      AddRow(x - set.t.cast<double>(), gradient, offset, static_cast<double>(params_.sigma_px), H, g);
      if (!line.has_depth) continue;
      const auto measured = static_cast<double>(end == 0 ? line.disparity_a_px : line.disparity_b_px);
      const auto variance = static_cast<double>(end == 0 ? line.var_a : line.var_b);
      const Vector3d by_depth(0, 0, -camera_.f * camera_.baseline * iz * iz);
      const auto floor = static_cast<double>(params_.sigma_disparity_px);
      AddRow(x - set.t.cast<double>(), by_depth, measured - camera_.DisparityOfDepth(x.z()),
             std::sqrt(variance + floor * floor), H, g);
    }
  }

  // `p`: the point relative to the model origin, camera axes; `gradient`: of the measurement by the point.
  static void AddRow(const Vector3d& p, const Vector3d& gradient, double residual, double sigma, Matrix6d& H,
                     Vector6d& g) {
    Vector6d J;
    J.head<3>() = p.cross(gradient);
    J.tail<3>() = gradient;
    const double r = residual / (3 * sigma);
    const double w = 1 / ((1 + r * r) * sigma * sigma);  // Cauchy
    H += w * J * J.transpose();
    g += w * residual * J;
  }

  const PromotionParams& params_;
  const PoseScorer& scorer_;
  const RectifiedCamera& camera_;
  const PreparedModel& model_;
  const Lines3& lines_;
  SegmentEnds ends_;
  std::array<std::uint8_t, kMaxSegments> near_;
  FixedVector<Found, kMaxModelEdges> found_;
};

struct StrongerSet {
  bool operator()(const CorrespondingSet& p, const CorrespondingSet& q) const {
    return p.strength != q.strength ? p.strength > q.strength : p.t.x() < q.t.x();
  }
};

// A pose, and how many hypotheses are it.
struct DistinctPose {
  const Hypothesis* first;
  int count;
};
using DistinctPoses = FixedVector<DistinctPose, kMaxPromoted>;

// Gives the number of hypotheses of other poses than those that `out` has room for.
std::uint32_t FindDistinct(const PromotionParams& params, const PreparedModel& model,
                           std::span<const Hypothesis> hypotheses, DistinctPoses& out) {
  std::uint32_t dropped = 0;
  const float tolerance = params.duplicate_share * model.view.diameter_m;
  for (const Hypothesis& h : hypotheses) {
    if (h.score < params.min_score_share * hypotheses[0].score) break;
    const auto same = std::find_if(out.begin(), out.end(), [&](const DistinctPose& d) {
      return IsSamePose(model, h.R, h.t, d.first->R, d.first->t, tolerance);
    });
    if (same != out.end()) {
      ++same->count;
    } else if (!out.try_push_back({&h, 1})) {
      ++dropped;
    }
  }
  return dropped;
}

// `sets` by falling strength.
void MergeSets(const PreparedModel& model, std::span<const CorrespondingSet> sets, float tolerance_m,
               CorrespondingSets& out) {
  for (const CorrespondingSet& set : sets) {
    const auto same = std::find_if(out.begin(), out.end(), [&](const CorrespondingSet& k) {
      return IsSamePose(model, set.R, set.t, k.R, k.t, tolerance_m);
    });
    if (same != out.end()) {
      same->evidence.hypotheses += set.evidence.hypotheses;
    } else {
      out.push_back(set);  // of at most kMaxPromoted
    }
  }
}

void RankSets(CorrespondingSets& sets) {
  float best = 0;
  for (const CorrespondingSet& set : sets) best = std::max(best, set.score);
  for (CorrespondingSet& set : sets) {
    set.evidence.score_share = best > 0 ? set.score / best : 0.0F;
    set.rank = ScoreOf(DefaultRankTable(), TermsOf(set.evidence));
  }
  std::sort(sets.begin(), sets.end(), [](const CorrespondingSet& p, const CorrespondingSet& q) {
    return p.rank != q.rank ? p.rank > q.rank : StrongerSet()(p, q);
  });
}

}  // namespace

bool IsSamePose(const PreparedModel& model, const Matrix3& R1, const Vector3& t1, const Matrix3& R2, const Vector3& t2,
                float tolerance_m) {
  const Vector3 apart = (R1 * model.centre + t1) - (R2 * model.centre + t2);
  const float nearby = tolerance_m + model.max_centre_shift_m;
  if (apart.squaredNorm() >= nearby * nearby) return false;  // almost always
  const float limit = tolerance_m * tolerance_m;
  for (const Pose& symmetry : model.symmetries) {
    const Matrix3 S = symmetry.R.cast<float>();
    const Vector3 s = symmetry.t.cast<float>();
    const auto meets = [&](const Vector3& corner) {
      return ((R1 * corner + t1) - (R2 * (S * corner + s) + t2)).squaredNorm() < limit;
    };
    if (std::all_of(model.corners.begin(), model.corners.end(), meets)) return true;
  }
  return false;
}

std::uint32_t PromoteSets(const PromotionParams& params, const PoseScorer& scorer, const RectifiedCamera& camera,
                          const PreparedModel& model, const Lines3& lines, std::span<const Hypothesis> hypotheses,
                          CorrespondingSets& out) {
  out.clear();
  DistinctPoses distinct;
  const std::uint32_t dropped = FindDistinct(params, model, hypotheses, distinct);
  KeepBest<CorrespondingSet, kMaxPromoted, StrongerSet> promoted;
  Promoter promoter(params, scorer, camera, model, lines);
  for (const DistinctPose& pose : distinct) {
    CorrespondingSet set;
    if (!promoter.Promote(*pose.first, set)) continue;
    set.evidence.hypotheses = static_cast<float>(pose.count);
    promoted.Push(set);
  }
  // Aligned poses meet again.
  MergeSets(model, promoted.Sorted(), params.aligned_duplicate_share * model.view.diameter_m, out);
  RankSets(out);
  return dropped;
}

std::span<const CorrespondingSet> WorthRefining(const PromotionParams& params, const CorrespondingSets& sets) {
  std::size_t count = 0;
  while (count < std::min(sets.size(), kMaxRefined) && sets[count].rank >= params.min_rank) ++count;
  return {sets.begin(), count};
}

}  // namespace wirepose
