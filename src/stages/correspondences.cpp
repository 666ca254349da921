#include "stages/correspondences.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/simd.h"
#include "base/work_budget.h"

namespace wirepose {
namespace {

constexpr float kUnlimited = 1e6F;
constexpr std::size_t kLanes = PreparedMembers::kLanes;

// What the members of a set must be like that a pair of image lines may correspond to.
struct Limits {
  float min_distance_m, max_distance_m;
  float angle_rad, max_angle_rad;    // the pair's, and how far a member's may be from it
  float min_farthest_end_m;          // no member is smaller than what was seen of it
  float min_length_m, max_length_m;  // of the other edge
};

constexpr std::size_t WholeVectors(std::size_t count) { return (count + kLanes - 1) / kLanes; }
using Misfits = std::array<float, WholeVectors(kMaxLineSetEdges) * kLanes>;

// By how much the members [first, first + count) exceed the limit that they exceed most, in its own unit: not positive
// where a member is within all of them. In whole vectors: what follows the last member is computed and not used.
WIREPOSE_VECTOR_KERNEL void MeasureMisfits(const PreparedMembers& members, std::size_t first, std::size_t count,
                                           const Limits& limits, Misfits& out) {
  const float* distance = members.distance_m.data() + first;
  const float* angle = members.angle_rad.data() + first;
  const float* farthest = members.farthest_end_m.data() + first;
  const float* length = members.other_length_m.data() + first;
  const Limits at = limits;
  const std::size_t lanes = WholeVectors(count) * kLanes;
  for (std::size_t k = 0; k < lanes; ++k) {
    const float near = at.min_distance_m - distance[k], far = distance[k] - at.max_distance_m;
    const float turned = std::abs(at.angle_rad - angle[k]) - at.max_angle_rad;
    const float small = at.min_farthest_end_m - farthest[k];
    const float shorter = at.min_length_m - length[k], longer = length[k] - at.max_length_m;
    float worst = near > far ? near : far;
    worst = worst > turned ? worst : turned;
    worst = worst > small ? worst : small;
    worst = worst > shorter ? worst : shorter;
    out[k] = worst > longer ? worst : longer;
  }
}

class Matcher {
 public:
  Matcher(const CorrespondenceParams& params, const RectifiedCamera& camera, const PreparedModel& model,
          const Lines3& lines, const ImageLineSets& sets, CorrespondingPairs& out)
      : params_(params), camera_(camera), model_(model), sets_(sets), out_(out), budget_(params.max_steps) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (!lines[i].has_depth) continue;
      length_[i] = lines[i].Length();
      slack_[i] = SlackOf(lines[i]);
    }
  }

  [[nodiscard]] bool budget_hit() const { return budget_.hit(); }

  void MatchBase(std::size_t base) {
    const float length = length_[base];
    const float slack = slack_[base];
    const std::span<const ImageLinePair> pairs = sets_.OfBase(base);
    // Both sets of one base edge follow each other; they are combined, since they share it (paper: "combined if they
    // share a line").
    for (std::size_t first = 0, next = 0; first < model_.sets.size(); first = next) {
      const std::uint16_t e = model_.sets[first].base_edge;
      while (next < model_.sets.size() && model_.sets[next].base_edge == e) ++next;
      const PreparedEdge& edge = model_.edges[e];
      if (!Fits(length, slack, edge.length_m, params_.min_cover)) continue;
      base_cover_ = std::min(1.0F, length / edge.length_m);
      MatchPairs({model_.sets.begin() + first, model_.sets.begin() + next}, pairs);
      Promote();
    }
  }

 private:
  void MatchPairs(std::span<const PreparedSet> sets, std::span<const ImageLinePair> pairs) {
    for (const ImageLinePair& pair : pairs) {
      const float room = RoomOf(pair);
      if (room < 0 || !budget_.Spend(1)) break;  // nor can the rest: pairs come by falling quality
      for (const PreparedSet& set : sets) {
        if (pair.kind == set.kind) MatchPair(set, pair, room);
      }
    }
  }

  // What the length of a line may be wrong by: its ends by a pixel or two, its depth by its sigma.
  [[nodiscard]] float SlackOf(const Line3& line) const {
    const float metres_per_px = 0.5F * (line.a.z() + line.b.z()) / static_cast<float>(camera_.f);
    return params_.end_tolerance_m + 2 * metres_per_px + params_.sigmas * DirectionSigma(camera_, line) * line.Length();
  }

  [[nodiscard]] bool Fits(float length, float slack, float edge_length, float min_cover) const {
    return length < edge_length * (1 + params_.length_tolerance) + slack && length + slack > min_cover * edge_length;
  }

  // The most that promotion can add.
  [[nodiscard]] float MaxPromotion() const { return params_.promotion * static_cast<float>(params_.max_promotions); }

  // By how much the best conceivable match of this pair outranks what is dropped: the most that a misfit may cost.
  [[nodiscard]] float RoomOf(const ImageLinePair& pair) const {
    const float best = pair.quality + params_.cover_gain * (1 + base_cover_) + params_.junction_gain + MaxPromotion();
    return out_.worst() ? best - out_.worst()->rank : kUnlimited;
  }

  void MatchPair(const PreparedSet& set, const ImageLinePair& pair, float room) {
    if (!pair.metric) {
      for (std::size_t i = set.first; i < set.corner_end; ++i) Emit(set, i, pair);
      return;
    }
    const float longest = 1 + params_.length_tolerance, shortest = 1 - params_.length_tolerance;
    const float slack = params_.end_tolerance_m + params_.sigmas * pair.distance_sigma_m;
    Limits limits;
    limits.min_farthest_end_m = (pair.farthest_end_m - slack) / longest;
    // Most pairs of a scene are too far apart for any member.
    if (limits.min_farthest_end_m > set.max_farthest_end_m) return;
    const float max_distance = (pair.distance_m + slack) / shortest;
    // Nor can a member be kept that is farther off than this many standard deviations.
    const float sigmas = std::sqrt(2 * room);
    const float reach = sigmas * DistanceSigma(pair, max_distance);
    limits.min_distance_m = std::max((pair.distance_m - slack) / longest, pair.distance_m - reach);
    if (limits.min_distance_m > set.max_distance_m) return;
    const std::size_t count = set.end - set.first;
    if (!budget_.Spend(static_cast<std::uint32_t>(WholeVectors(count)))) return;
    limits.max_distance_m = std::min(max_distance, pair.distance_m + reach);
    limits.angle_rad = pair.angle_rad;
    limits.max_angle_rad =
        std::min(params_.angle_tolerance_rad + params_.sigmas * pair.angle_sigma_rad, sigmas * AngleSigma(pair));
    limits.min_length_m = (length_[pair.other] - slack_[pair.other]) / longest;
    limits.max_length_m = (length_[pair.other] + slack_[pair.other]) / params_.min_other_cover;
    MeasureMisfits(model_.members, set.first, count, limits, misfits_);
    for (std::size_t k = 0; k < count; ++k) {
      if (misfits_[k] <= 0) Emit(set, set.first + k, pair);
    }
  }

  void Emit(const PreparedSet& set, std::size_t member, const ImageLinePair& pair) {
    const std::uint8_t base_end = model_.members.base_end[member];
    CorrespondingPair match;
    match.image_pair = static_cast<std::uint16_t>(&pair - sets_.pairs.data());
    match.base_edge = set.base_edge;
    match.other_edge = model_.members.other_edge[member];
    match.rank = pair.quality + params_.cover_gain * base_cover_ +
                 (pair.metric ? Agreement(pair, member) : -params_.no_depth_loss);
    if (pair.base_end != LineEnd::kNone && base_end != 2) {
      match.junction = 1;
      match.base_flipped = base_end == static_cast<std::uint8_t>(pair.base_end) ? 0 : 1;
      match.rank += params_.junction_gain;
      Collect(match);
      return;
    }
    if (!pair.metric) return;
    for (const std::uint8_t flipped : {0, 1}) {
      match.base_flipped = flipped;
      Collect(match);
    }
  }

  static float AngleSigma(const ImageLinePair& pair) { return 0.02F + pair.angle_sigma_rad; }
  static float DistanceSigma(const ImageLinePair& pair, float distance_m) {
    return 0.003F + 0.01F * distance_m + pair.distance_sigma_m;
  }

  // Exponent of the Gaussian of V, and the other line's cover.
  [[nodiscard]] float Agreement(const ImageLinePair& pair, std::size_t member) const {
    const PreparedMembers& members = model_.members;
    const float angle = (pair.angle_rad - members.angle_rad[member]) / AngleSigma(pair);
    const float distance =
        (pair.distance_m - members.distance_m[member]) / DistanceSigma(pair, members.distance_m[member]);
    const float cover = std::min(1.0F, length_[pair.other] / members.other_length_m[member]);
    return params_.cover_gain * cover - 0.5F * (angle * angle + distance * distance);
  }

  void Collect(const CorrespondingPair& match) {
    // With the most that promotion can add it would still be dropped: it only counts for the others.
    const bool hopeless = out_.worst() && match.rank + MaxPromotion() < out_.worst()->rank;
    if (hopeless || !matches_.try_push_back(match)) out_.CountDropped(1);
    EdgeBits& edges = edges_[match.base_flipped];
    edges[match.other_edge / 32] |= 1U << (match.other_edge % 32);
  }

  // Corresponding sets that share the base line and its edge are promoted: each ranks by the number of model edges
  // that found an image line under this assignment.
  void Promote() {
    float promotion[2];
    for (std::size_t flip = 0; flip < 2; ++flip) {
      int count = 0;
      for (const std::uint32_t word : edges_[flip]) count += std::popcount(word);
      promotion[flip] = params_.promotion * static_cast<float>(std::min(count, params_.max_promotions));
      edges_[flip] = {};
    }
    for (CorrespondingPair& match : matches_) {
      match.rank += promotion[match.base_flipped];
      out_.Push(match);
    }
    matches_.clear();
  }

  const CorrespondenceParams& params_;
  const RectifiedCamera& camera_;
  const PreparedModel& model_;
  const ImageLineSets& sets_;
  CorrespondingPairs& out_;
  std::array<float, kMaxSegments> length_{}, slack_{};  // of lines with depth, m
  // Of the base line and base edge at hand.
  float base_cover_ = 0;
  FixedVector<CorrespondingPair, 2048> matches_;
  EdgeBits edges_[2] = {};
  Misfits misfits_;  // of the members compared last
  WorkBudget budget_;
};

}  // namespace

bool FindCorrespondences(const CorrespondenceParams& params, const RectifiedCamera& camera, const PreparedModel& model,
                         const Lines3& lines, const ImageLineSets& sets, CorrespondingPairs& out) {
  out.clear();
  Matcher matcher(params, camera, model, lines, sets, out);
  for (std::size_t b = 0; b < lines.size(); ++b) {
    if (sets.first[b] != sets.first[b + 1] && !matcher.budget_hit()) matcher.MatchBase(b);
  }
  return !matcher.budget_hit();
}

}  // namespace wirepose
