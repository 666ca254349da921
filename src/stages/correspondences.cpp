#include "stages/correspondences.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace wirepose {
namespace {

// Whose ends meet in the corner that two model edges share; kNone when they share none.
struct Corner {
  LineEnd base = LineEnd::kNone;
  LineEnd other = LineEnd::kNone;
};

Corner SharedCorner(const PreparedEdge& p, const PreparedEdge& q, float tolerance) {
  const float limit = tolerance * tolerance;
  if ((p.a - q.a).squaredNorm() < limit) return {LineEnd::kA, LineEnd::kA};
  if ((p.a - q.b).squaredNorm() < limit) return {LineEnd::kA, LineEnd::kB};
  if ((p.b - q.a).squaredNorm() < limit) return {LineEnd::kB, LineEnd::kA};
  if ((p.b - q.b).squaredNorm() < limit) return {LineEnd::kB, LineEnd::kB};
  return {};
}

class Matcher {
 public:
  Matcher(const CorrespondenceParams& params, const RectifiedCamera& camera, const PreparedModel& model,
          const Lines3& lines, const ImageLineSets& sets, CorrespondingPairs& out)
      : params_(params), camera_(camera), model_(model), lines_(lines), sets_(sets), out_(out) {}

  void MatchBase(std::size_t base) {
    const Line3& line = lines_[base];
    const float length = line.Length();
    const float slack = Slack(line);
    for (const ModelLineSet& set : model_.view.line_sets) {
      const PreparedEdge& edge = model_.edges[set.base_edge];
      if (!edge.representative || !Fits(length, slack, edge.length_m, params_.min_cover)) continue;
      base_cover_ = std::min(1.0F, length / edge.length_m);
      // Both sets of one base edge are combined, since they share it (paper: "combined if they share a line").
      if (set.base_edge != assigned_edge_) Promote();
      assigned_edge_ = set.base_edge;
      for (const ImageLinePair& pair : sets_.OfBase(base)) {
        if (pair.metric && pair.kind != set.kind) continue;
        if (!pair.metric && set.kind != LineSetKind::kIntersecting) continue;
        MatchPair(set, pair);
      }
    }
    Promote();
  }

 private:
  // What the length of a line may be wrong by: its ends by a pixel or two, its depth by its sigma.
  [[nodiscard]] float Slack(const Line3& line) const {
    const float metres_per_px = 0.5F * (line.a.z() + line.b.z()) / static_cast<float>(camera_.f);
    return params_.end_tolerance_m + 2 * metres_per_px + params_.sigmas * DirectionSigma(camera_, line) * line.Length();
  }

  [[nodiscard]] bool Fits(float length, float slack, float edge_length, float min_cover) const {
    return length < edge_length * (1 + params_.length_tolerance) + slack && length + slack > min_cover * edge_length;
  }

  void MatchPair(const ModelLineSet& set, const ImageLinePair& pair) {
    const auto members = model_.view.set_members.subspan(set.first_member, set.member_count);
    for (const ModelSetMember& member : members) {
      if (pair.metric ? MetricAgrees(pair, member) : member.nearest_end_m < Near()) Emit(set, member, pair);
    }
  }

  [[nodiscard]] float Near() const { return 0.02F * model_.view.diameter_m; }

  [[nodiscard]] bool MetricAgrees(const ImageLinePair& pair, const ModelSetMember& member) const {
    if (std::abs(pair.angle_rad - member.angle_rad) > params_.angle_tolerance_rad + params_.sigmas * pair.angle_sigma_rad) {
      return false;
    }
    const float slack = params_.end_tolerance_m + params_.sigmas * pair.distance_sigma_m;
    if (std::abs(pair.distance_m - member.distance_m) > slack + params_.length_tolerance * member.distance_m) return false;
    if (pair.farthest_end_m > member.farthest_end_m * (1 + params_.length_tolerance) + slack) return false;
    const Line3& other = lines_[pair.other];
    const PreparedEdge& edge = model_.edges[member.edge];
    return Fits(other.Length(), Slack(other), edge.length_m, params_.min_other_cover);
  }

  void Emit(const ModelLineSet& set, const ModelSetMember& member, const ImageLinePair& pair) {
    CorrespondingPair match;
    match.image_pair = static_cast<std::uint16_t>(&pair - sets_.pairs.data());
    match.base_edge = set.base_edge;
    match.other_edge = member.edge;
    match.rank = base_cover_;
    if (pair.metric) match.rank += std::min(1.0F, lines_[pair.other].Length() / model_.edges[member.edge].length_m);
    if (pair.base_end != LineEnd::kNone && member.nearest_end_m < Near()) {
      const Corner corner = SharedCorner(model_.edges[set.base_edge], model_.edges[member.edge], Near());
      if (corner.base != LineEnd::kNone) {
        match.junction = 1;
        match.base_flipped = corner.base == pair.base_end ? 0 : 1;
        match.rank += 0.5F;
        Collect(match);
        return;
      }
    }
    if (!pair.metric) return;
    for (std::uint8_t flipped : {0, 1}) {
      match.base_flipped = flipped;
      Collect(match);
    }
  }

  void Collect(const CorrespondingPair& match) {
    if (!matches_.try_push_back(match)) ++out_of_room_;
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
      promotion[flip] = params_.promotion * static_cast<float>(std::min(count, 16));
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
  const Lines3& lines_;
  const ImageLineSets& sets_;
  CorrespondingPairs& out_;
  // Of the base line and base edge at hand.
  float base_cover_ = 0;
  std::uint16_t assigned_edge_ = kNoFace;
  FixedVector<CorrespondingPair, 2048> matches_;
  EdgeBits edges_[2] = {};
  std::uint32_t out_of_room_ = 0;
};

}  // namespace

void FindCorrespondences(const CorrespondenceParams& params, const RectifiedCamera& camera, const PreparedModel& model,
                         const Lines3& lines, const ImageLineSets& sets, CorrespondingPairs& out) {
  out.clear();
  Matcher matcher(params, camera, model, lines, sets, out);
  for (std::size_t b = 0; b < lines.size(); ++b) {
    if (sets.first[b] != sets.first[b + 1]) matcher.MatchBase(b);
  }
}

}  // namespace wirepose
