#include "stages/correspondences.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/work_budget.h"

namespace wirepose {
namespace {

constexpr float kUnlimited = 1e6F;

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
      if (RoomOf(pair) < 0 || !budget_.Spend(1)) break;  // nor can the rest: pairs come by falling quality
      const float room = RoomOf(pair) - Missing(pair);
      if (room < 0) continue;
      for (const PreparedSet& set : sets) {
        if (pair.kind == set.kind) MatchPair(set, pair, std::sqrt(2 * room));
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

  // By how much the best conceivable match of this pair outranks what is dropped: the most that a misfit may cost.
  [[nodiscard]] float RoomOf(const ImageLinePair& pair) const {
    const float best = pair.quality + params_.cover_gain * (1 + base_cover_) + params_.junction_gain +
                       params_.promotion * static_cast<float>(params_.max_promotions);
    return out_.worst() ? best - out_.worst()->rank : kUnlimited;
  }

  // What the best conceivable match gains and one of this pair cannot.
  [[nodiscard]] float Missing(const ImageLinePair& pair) const {
    return (pair.metric ? 0.0F : params_.cover_gain + params_.no_depth_loss) +
           (pair.base_end == LineEnd::kNone ? params_.junction_gain : 0.0F);
  }

  // `sigmas`: no member farther off than this many standard deviations can be kept.
  void MatchPair(const PreparedSet& set, const ImageLinePair& pair, float sigmas) {
    if (!pair.metric) {
      for (std::size_t i = set.first; i < set.corner_end; ++i) Emit(set, model_.members[i], pair);
      return;
    }
    const float slack = params_.end_tolerance_m + params_.sigmas * pair.distance_sigma_m;
    // Most pairs of a scene are too far apart for any member.
    if (pair.farthest_end_m > set.max_farthest_end_m * (1 + params_.length_tolerance) + slack) return;
    // Members whose distance agrees: a few of the rest by binary search, and those at a corner when the lines may meet.
    float high = (pair.distance_m + slack) / (1 - params_.length_tolerance);
    float low = (pair.distance_m - slack) / (1 + params_.length_tolerance);
    const float reach = sigmas * DistanceSigma(pair, high);
    high = std::min(high, pair.distance_m + reach);
    low = std::max(low, pair.distance_m - reach);
    const float max_angle =
        std::min(params_.angle_tolerance_rad + params_.sigmas * pair.angle_sigma_rad, sigmas * AngleSigma(pair));
    MatchRange(set, set.first, set.corner_end, {low, high, max_angle}, pair);
    MatchRange(set, set.corner_end, set.end, {low, high, max_angle}, pair);
  }

  struct Limits {
    float low_m, high_m;  // of the distance
    float max_angle_rad;  // between the pair's and the member's angle
  };

  void MatchRange(const PreparedSet& set, std::size_t begin, std::size_t end, const Limits& limits,
                  const ImageLinePair& pair) {
    const PreparedMember* members = model_.members.data();
    if (begin == end || members[end - 1].distance_m < limits.low_m) return;
    const PreparedMember* from =
        std::lower_bound(members + begin, members + end, limits.low_m,
                         [](const PreparedMember& m, float value) { return m.distance_m < value; });
    for (const PreparedMember* m = from; m != members + end && m->distance_m <= limits.high_m && budget_.Spend(1);
         ++m) {
      if (std::abs(pair.angle_rad - m->angle_rad) <= limits.max_angle_rad && SizeAgrees(pair, *m)) Emit(set, *m, pair);
    }
  }

  [[nodiscard]] float OtherLength(const PreparedMember& member) const {
    return model_.edges[member.other_edge].length_m;
  }

  [[nodiscard]] bool SizeAgrees(const ImageLinePair& pair, const PreparedMember& member) const {
    const float slack = params_.end_tolerance_m + params_.sigmas * pair.distance_sigma_m;
    if (pair.farthest_end_m > member.farthest_end_m * (1 + params_.length_tolerance) + slack) return false;
    return Fits(length_[pair.other], slack_[pair.other], OtherLength(member), params_.min_other_cover);
  }

  void Emit(const PreparedSet& set, const PreparedMember& member, const ImageLinePair& pair) {
    CorrespondingPair match;
    match.image_pair = static_cast<std::uint16_t>(&pair - sets_.pairs.data());
    match.base_edge = set.base_edge;
    match.other_edge = member.other_edge;
    match.rank = pair.quality + params_.cover_gain * base_cover_ +
                 (pair.metric ? Agreement(pair, member) : -params_.no_depth_loss);
    if (pair.base_end != LineEnd::kNone && member.base_end != 2) {
      match.junction = 1;
      match.base_flipped = member.base_end == static_cast<std::uint8_t>(pair.base_end) ? 0 : 1;
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
  [[nodiscard]] float Agreement(const ImageLinePair& pair, const PreparedMember& member) const {
    const float angle = (pair.angle_rad - member.angle_rad) / AngleSigma(pair);
    const float distance = (pair.distance_m - member.distance_m) / DistanceSigma(pair, member.distance_m);
    const float cover = std::min(1.0F, length_[pair.other] / OtherLength(member));
    return params_.cover_gain * cover - 0.5F * (angle * angle + distance * distance);
  }

  void Collect(const CorrespondingPair& match) {
    // With the most that promotion can add it would still be dropped: it only counts for the others.
    const float best = match.rank + params_.promotion * static_cast<float>(params_.max_promotions);
    if ((out_.worst() && best < out_.worst()->rank) || !matches_.try_push_back(match)) out_.CountDropped(1);
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
