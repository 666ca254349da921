#include "tests/targets/stage_hasher.h"

namespace wirepose::testing {
namespace {

void HashSegment(const Segment2& s, Digest& digest) {
  digest.Add(s.a, s.b, s.contrast, s.sigma_offset_px, s.sigma_angle_rad);
}

void HashLine(const Line3& line, Digest& digest) {
  digest.Add(line.id, line.has_depth, line.owner);
  HashSegment(line.segment, digest);
  digest.Add(line.disparity_a_px, line.disparity_b_px, line.var_a, line.var_b, line.cov_ab, line.a, line.b);
}

void HashPair(const ImageLinePair& p, Digest& digest) {
  digest.Add(p.base, p.other, p.kind, p.metric, p.base_end, p.other_end, p.angle_rad, p.angle_sigma_rad, p.distance_m,
             p.distance_sigma_m, p.farthest_end_m, p.quality);
}

// Of lists in which the order is not part of the result.
template <typename List, typename HashItem>
void HashUnordered(const List& list, Digest& digest, const HashItem& hash_item) {
  std::uint64_t sum = 0;
  for (const auto& item : list) {
    Digest one;
    hash_item(item, one);
    sum += one.value();
  }
  digest.Add(sum);
}

template <typename List, typename HashItem>
void HashOrdered(const List& list, Digest& digest, const HashItem& hash_item) {
  for (const auto& item : list) hash_item(item, digest);
}

void HashDisparityMap(const DisparityMap& map, Digest& digest) {
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      digest.Add(map.disparity[static_cast<std::size_t>(y * DisparityMap::kMaxWidth + x)]);
    }
  }
}

}  // namespace

void StageHasher::DoStageDone(Stage stage) {
  Digest& digest = digests_[static_cast<std::size_t>(stage)];
  switch (stage) {
    case Stage::kRectify:
      digest.Add(recognizer_.left_rectified());
      digest.Add(recognizer_.right_rectified());
      return;
    case Stage::kSegments:
      return HashOrdered(recognizer_.left_segments(), digest, HashSegment);
    case Stage::kStereoLines:
      HashDisparityMap(recognizer_.disparity_map(), digest);
      for (const RowOffset& o : recognizer_.row_offsets()) digest.Add(o.x_px, o.y_px, o.disparity_px, o.offset_px);
      return HashOrdered(recognizer_.lines(), digest, HashLine);
    case Stage::kLineSets:
      return HashOrdered(recognizer_.line_sets().pairs, digest, HashPair);
    case Stage::kCorrespondences:
      return HashMatches(digest);
    case Stage::kHypotheses:
      return HashHypotheses(digest);
    case Stage::kVerify:
      return HashCandidates(digest);
    case Stage::kRefine:
    case Stage::kSelect:
      return;
  }
}

void StageHasher::HashMatches(Digest& digest) const {
  HashUnordered(recognizer_.corresponding_pairs(), digest, [](const CorrespondingPair& p, Digest& d) {
    d.Add(p.image_pair, p.base_edge, p.other_edge, p.base_flipped, p.junction, p.rank);
  });
}

void StageHasher::HashHypotheses(Digest& digest) const {
  HashUnordered(recognizer_.hypotheses(), digest, [](const Hypothesis& h, Digest& d) {
    d.Add(h.R, h.t, h.score, h.base_line, h.other_line, h.base_edge, h.other_edge);
  });
  HashOrdered(recognizer_.sets(), digest, [](const CorrespondingSet& set, Digest& d) {
    d.Add(set.R, set.t, set.line_count, set.face_count, set.score, set.strength, set.rank);
    for (const SetMember& m : set.members) d.Add(m.line, m.edge);
  });
}

void StageHasher::HashCandidates(Digest& digest) const {
  HashUnordered(recognizer_.candidates(), digest, [](const Candidate& c, Digest& d) {
    d.Add(c.model, c.order, c.score);
    d.Add(c.pose.T_camera_model, c.pose.covariance, c.pose.rms_px, c.pose.inliers, c.pose.ok);
    for (const float term : TermsOf(c.evidence)) d.Add(term);
    for (const SetMember& m : c.members) d.Add(m.line, m.edge);
  });
}

}  // namespace wirepose::testing
