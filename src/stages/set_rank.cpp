#include "stages/set_rank.h"

namespace wirepose {

SetTerms TermsOf(const SetEvidence& e) {
  return {e.score,       e.score_share,      e.left,    e.right,     e.edges, e.lines, e.depth_share,
          e.residual_px, e.disparity_misfit, e.overrun, e.hypotheses};
}

const std::array<const char*, kSetTerms>& SetTermNames() {
  static constexpr std::array<const char*, kSetTerms> kNames = {
      "score",       "score_share",      "left",    "right",     "edges", "lines", "depth_share",
      "residual_px", "disparity_misfit", "overrun", "hypotheses"};
  return kNames;
}

}  // namespace wirepose
