#include "stages/correspondences.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/check.h"
#include "base/portable_math.h"
#include "base/work_budget.h"

namespace wirepose {
namespace {

constexpr float kUnlimited = 1e6F;

class Matcher {
 public:
  Matcher(const CorrespondenceParams& params, const RectifiedCamera& camera, const PreparedModel& model,
          const Lines3& lines, const ImageLineSets& sets, CorrespondingPairs& out)
      : params_(params),
        camera_(camera),
        model_(model),
        sets_(sets),
        out_(out),
        ranker_(params.rank, model, lines),
        budget_(params.max_steps) {
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
    RankPairs(sets_.OfBase(base));
    // Both sets of one base edge follow each other; they are combined, since they share it (paper: "combined if they
    // share a line").
    for (std::size_t first = 0, next = 0; first < model_.sets.size(); first = next) {
      const std::uint16_t e = model_.sets[first].base_edge;
      while (next < model_.sets.size() && model_.sets[next].base_edge == e) ++next;
      const PreparedEdge& edge = model_.edges[e];
      if (!Fits(length, slack, edge.length_m, params_.min_cover)) continue;
      RankBase(e, std::min(1.0F, length / edge.length_m));
      MatchPairs({model_.sets.begin() + first, model_.sets.begin() + next});
      Promote();
    }
  }

 private:
  // The rank of a pair as far as the pair itself decides it, and the most that member and promotions can make of it.
  struct PairRank {
    float known = 0, most = 0;
  };

  // What is the same for every base edge: the rank at a corner of the model and elsewhere, and which distances a member
  // may have.
  struct PairRanks {
    PairRank corner, apart;
    std::uint16_t pair = 0;
    float slack_m = 0, low_m = 0, high_m = 0;
    [[nodiscard]] float Most() const { return std::max(corner.most, apart.most); }
  };

  [[nodiscard]] PairRank RankAs(PairClass c, const ImageLinePair& pair) const {
    const float known = ranker_.OfPair(c, pair);
    return {known, known + ranker_.Most(c, pair, length_[pair.other])};
  }

  static bool Meets(const ImageLinePair& pair) { return pair.base_end != LineEnd::kNone; }

  [[nodiscard]] PairRanks RanksOf(const ImageLinePair& pair) const {
    const PairRank apart = RankAs(ClassOf(pair, false), pair);
    const float slack = params_.end_tolerance_m + params_.sigmas * pair.distance_sigma_m;
    return {Meets(pair) ? RankAs(ClassOf(pair, true), pair) : apart,
            apart,
            static_cast<std::uint16_t>(&pair - sets_.pairs.data()),
            slack,
            (pair.distance_m - slack) / (1 + params_.length_tolerance),
            (pair.distance_m + slack) / (1 - params_.length_tolerance)};
  }

  void RankPairs(std::span<const ImageLinePair> pairs) {
    pair_ranks_.clear();
    for (const ImageLinePair& pair : pairs) pair_ranks_.push_back(RanksOf(pair));
    std::sort(pair_ranks_.begin(), pair_ranks_.end(), [](const PairRanks& p, const PairRanks& q) {
      return p.Most() != q.Most() ? p.Most() > q.Most() : p.pair < q.pair;
    });
  }

  void RankBase(std::size_t edge, float cover) {
    for (std::size_t c = 0; c < kPairClasses; ++c)
      base_rank_[c] = ranker_.OfBase(static_cast<PairClass>(c), edge, cover);
  }

  void MatchPairs(std::span<const PreparedSet> sets) {
    const float most_of_base = *std::max_element(base_rank_.begin(), base_rank_.end());
    for (const PairRanks& ranks : pair_ranks_) {
      if (out_.worst() && ranks.Most() + most_of_base < out_.worst()->rank) break;  // nor can the rest
      if (!budget_.Spend(1)) break;
      const ImageLinePair& pair = sets_.pairs[ranks.pair];
      const Rank corner = RankOf(ClassOf(pair, Meets(pair)), ranks.corner);
      const Rank apart = RankOf(ClassOf(pair, false), ranks.apart);
      if (std::max(corner.room, apart.room) < 0) continue;
      for (const PreparedSet& set : sets) {
        if (pair.kind == set.kind) MatchPair(set, ranks, corner, apart);
      }
    }
  }

  // What the lines of a length may be wrong by: its ends by a pixel or two, its depth by its sigma.
  [[nodiscard]] float SlackOf(const Line3& line) const {
    const float metres_per_px = 0.5F * (line.a.z() + line.b.z()) / static_cast<float>(camera_.f);
    return params_.end_tolerance_m + 2 * metres_per_px + params_.sigmas * DirectionSigma(camera_, line) * line.Length();
  }

  [[nodiscard]] bool Fits(float length, float slack, float edge_length, float min_cover) const {
    return length < edge_length * (1 + params_.length_tolerance) + slack && length + slack > min_cover * edge_length;
  }

  // The rank of a pair with base line and base edge, before it is known which member matches.
  struct Rank {
    PairClass pair_class;
    float known;
    float room;  // by how much the best conceivable match outranks what is dropped
  };

  [[nodiscard]] Rank RankOf(PairClass c, const PairRank& pair) const {
    const float base = base_rank_[static_cast<std::size_t>(c)];
    return {c, pair.known + base, out_.worst() ? pair.most + base - out_.worst()->rank : kUnlimited};
  }

  void MatchPair(const PreparedSet& set, const PairRanks& ranks, const Rank& corner, const Rank& apart) {
    const ImageLinePair& pair = sets_.pairs[ranks.pair];
    if (!pair.metric) {
      for (std::size_t i = set.first; i < set.corner_end; ++i) Emit(set, model_.members[i], pair, corner);
      return;
    }
    // Most pairs of a scene are too far apart for any member.
    if (pair.farthest_end_m > set.max_farthest_end_m * (1 + params_.length_tolerance) + ranks.slack_m) return;
    if (ranks.low_m > set.max_distance_m) return;
    // Members whose distance agrees: a few of the rest by binary search, and those at a corner when the lines may meet.
    if (corner.room >= 0) MatchRange(set, set.first, set.corner_end, ranks, corner);
    if (apart.room >= 0) MatchRange(set, set.corner_end, set.end, ranks, apart);
  }

  void MatchRange(const PreparedSet& set, std::size_t begin, std::size_t end, const PairRanks& ranks,
                  const Rank& rank) {
    const PreparedMember* last = model_.members.data() + end;
    const PreparedMember* from =
        std::lower_bound(model_.members.data() + begin, last, ranks.low_m,
                         [](const PreparedMember& m, float value) { return m.distance_m < value; });
    if (from == last || from->distance_m > ranks.high_m) return;
    const ImageLinePair& pair = sets_.pairs[ranks.pair];
    const float max_angle = params_.angle_tolerance_rad + params_.sigmas * pair.angle_sigma_rad;
    // By how much angle and distance may differ before the match cannot be kept, squared.
    const float angle_sigma = AngleSigma(pair), distance_sigma = DistanceSigma(pair, ranks.high_m);
    const float angle_room = rank.room * angle_sigma * angle_sigma / ranker_.LossOfAngle(rank.pair_class);
    const float distance_room = rank.room * distance_sigma * distance_sigma / ranker_.LossOfDistance(rank.pair_class);
    for (const PreparedMember* m = from; m != last && m->distance_m <= ranks.high_m && budget_.Spend(1); ++m) {
      const float angle = std::abs(pair.angle_rad - m->angle_rad), distance = pair.distance_m - m->distance_m;
      if (angle > max_angle || angle * angle > angle_room || distance * distance > distance_room) continue;
      if (SizeAgrees(pair, *m, ranks.slack_m)) Emit(set, *m, pair, rank);
    }
  }

  [[nodiscard]] float OtherLength(const PreparedMember& member) const {
    return model_.edges[member.other_edge].length_m;
  }

  [[nodiscard]] bool SizeAgrees(const ImageLinePair& pair, const PreparedMember& member, float slack) const {
    if (pair.farthest_end_m > member.farthest_end_m * (1 + params_.length_tolerance) + slack) return false;
    return Fits(length_[pair.other], slack_[pair.other], OtherLength(member), params_.min_other_cover);
  }

  void Emit(const PreparedSet& set, const PreparedMember& member, const ImageLinePair& pair, const Rank& rank) {
    CorrespondingPair match;
    match.image_pair = static_cast<std::uint16_t>(&pair - sets_.pairs.data());
    match.base_edge = set.base_edge;
    match.other_edge = member.other_edge;
    const float other_cover = std::min(1.0F, length_[pair.other] / OtherLength(member));
    match.rank = rank.known + ranker_.OfOther(rank.pair_class, pair, member, other_cover);
    if (pair.base_end != LineEnd::kNone && member.base_end != 2) {
      match.junction = 1;
      match.base_flipped = member.base_end == static_cast<std::uint8_t>(pair.base_end) ? 0 : 1;
      Collect(match, rank.pair_class);
      return;
    }
    if (!pair.metric) return;
    for (const std::uint8_t flipped : {0, 1}) {
      match.base_flipped = flipped;
      Collect(match, rank.pair_class);
    }
  }

  void Collect(const CorrespondingPair& match, PairClass c) {
    // With the most that promotion can add it would still be dropped: it only counts for the others.
    const float best = match.rank + std::max(0.0F, ranker_.OfPromotions(c, kMaxPromotions));
    if ((out_.worst() && best < out_.worst()->rank) || !matches_.try_push_back(match)) out_.CountDropped(1);
    EdgeBits& edges = edges_[match.base_flipped];
    edges[match.other_edge / 32] |= 1U << (match.other_edge % 32);
  }

  // Corresponding sets that share the base line and its edge are promoted: each ranks by the number of model edges
  // that found an image line under this assignment.
  void Promote() {
    if (matches_.empty()) {
      edges_[0] = edges_[1] = {};
      return;
    }
    int promotions[2];
    for (std::size_t flip = 0; flip < 2; ++flip) {
      int count = 0;
      for (const std::uint32_t word : edges_[flip]) count += std::popcount(word);
      promotions[flip] = std::min(count, kMaxPromotions);
      edges_[flip] = {};
    }
    for (CorrespondingPair& match : matches_) {
      const int count = promotions[match.base_flipped];
      match.promotions = static_cast<std::uint8_t>(count);
      match.rank += ranker_.OfPromotions(ClassOf(sets_.pairs[match.image_pair], match.junction != 0), count);
      out_.Push(match);
    }
    matches_.clear();
  }

  const CorrespondenceParams& params_;
  const RectifiedCamera& camera_;
  const PreparedModel& model_;
  const ImageLineSets& sets_;
  CorrespondingPairs& out_;
  PairRanker ranker_;
  std::array<float, kMaxSegments> length_{}, slack_{};  // of lines with depth, m
  // Of the base line at hand, and of its base edge.
  FixedVector<PairRanks, kMaxSegments> pair_ranks_;  // by what they can rank at most
  std::array<float, kPairClasses> base_rank_{};
  FixedVector<CorrespondingPair, kMaxCorrespondences> matches_;  // of the base edge
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

namespace {

const PreparedMember& MemberOf(const PreparedModel& model, const ImageLinePair& pair, const CorrespondingPair& match) {
  const PreparedMember* found = nullptr;
  for (const PreparedSet& set : model.sets) {
    if (set.base_edge != match.base_edge || set.kind != pair.kind) continue;
    for (std::size_t i = set.first; i < set.end; ++i) {
      if (model.members[i].other_edge == match.other_edge) found = &model.members[i];
    }
  }
  Check(found != nullptr);  // the match was made of a member
  return *found;
}

}  // namespace

PairTerms TermsOf(const PreparedModel& model, const Lines3& lines, const ImageLineSets& sets,
                  const CorrespondingPair& match) {
  const ImageLinePair& pair = sets.pairs[match.image_pair];
  const PreparedMember& member = MemberOf(model, pair, match);
  const Line3 &base = lines[pair.base], &other = lines[pair.other];
  PairTerms terms{};
  const auto set = [&](PairTerm term, float value) { terms[static_cast<std::size_t>(term)] = value; };
  const auto share = [&](PairTerm term, PairTerm squared, float value) {
    set(term, std::min(1.0F, value));
    set(squared, std::min(1.0F, value) * std::min(1.0F, value));
  };
  const auto log_share = [&](std::size_t edge) { return Log(model.edges[edge].length_m / model.view.diameter_m); };
  set(PairTerm::kBasePx, Log(base.segment.Length()));
  set(PairTerm::kOtherPx, Log(other.segment.Length()));
  set(PairTerm::kDepth, Log(0.5F * (base.a.z() + base.b.z())));
  set(PairTerm::kMeet, pair.base_end == LineEnd::kNone ? 0.0F : 1.0F);
  set(PairTerm::kBaseEdge, log_share(match.base_edge));
  set(PairTerm::kOtherEdge, log_share(match.other_edge));
  share(PairTerm::kBaseCover, PairTerm::kBaseCoverSquared, base.Length() / model.edges[match.base_edge].length_m);
  set(PairTerm::kPromotion, match.promotions);
  if (!pair.metric) return terms;
  const float angle = (pair.angle_rad - member.angle_rad) / AngleSigma(pair);
  const float distance = (pair.distance_m - member.distance_m) / DistanceSigma(pair, member.distance_m);
  set(PairTerm::kAngleSigma, pair.log_angle_sigma);
  set(PairTerm::kDistanceSigma, pair.log_distance_sigma);
  set(PairTerm::kAngleSquared, angle * angle);
  set(PairTerm::kDistanceSquared, distance * distance);
  share(PairTerm::kOtherCover, PairTerm::kOtherCoverSquared, other.Length() / model.edges[match.other_edge].length_m);
  share(PairTerm::kReach, PairTerm::kReachSquared, pair.farthest_end_m / member.farthest_end_m);
  return terms;
}

}  // namespace wirepose
