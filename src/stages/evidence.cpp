#include "stages/evidence.h"

namespace wirepose {

EvidenceTerms TermsOf(const Evidence& evidence) {
  const EdgeEvidence& e = evidence.edges;
  const SurfaceEvidence& s = evidence.surface;
  return {e.visible_px,
          e.inside,
          e.edges,
          e.support,
          e.chance,
          e.sharp,
          e.sharp_of_support,
          e.spread_px,
          e.parallax_px,
          e.full_edges,
          e.weak_edges,
          e.weakest_edge,
          e.distinct,
          e.clear,
          e.dimmest_edge,
          e.outline,
          e.outline_distinct,
          e.inner_distinct,
          e.ends,
          e.corners,
          e.weakest_face,
          e.overrun,
          e.crossed,
          evidence.hidden,
          s.on,
          s.through,
          s.drop,
          s.level,
          s.misfit,
          evidence.disparity_px,
          evidence.rms_px,
          evidence.uncertainty};
}

const std::array<const char*, kEvidenceTerms>& EvidenceTermNames() {
  static constexpr std::array<const char*, kEvidenceTerms> kNames = {"visible_px",
                                                                     "inside",
                                                                     "edges",
                                                                     "support",
                                                                     "chance",
                                                                     "sharp",
                                                                     "sharp_of_support",
                                                                     "spread_px",
                                                                     "parallax_px",
                                                                     "full_edges",
                                                                     "weak_edges",
                                                                     "weakest_edge",
                                                                     "distinct",
                                                                     "clear",
                                                                     "dimmest_edge",
                                                                     "outline",
                                                                     "outline_distinct",
                                                                     "inner_distinct",
                                                                     "ends",
                                                                     "corners",
                                                                     "weakest_face",
                                                                     "overrun",
                                                                     "crossed",
                                                                     "hidden",
                                                                     "on",
                                                                     "through",
                                                                     "drop",
                                                                     "level",
                                                                     "misfit",
                                                                     "disparity_px",
                                                                     "rms_px",
                                                                     "uncertainty"};
  return kNames;
}

}  // namespace wirepose
