#include "tools/evaluation/evidence_terms.h"

namespace wirepose::evaluation {

std::vector<EvidenceTerm> EvidenceTerms(const Candidate& candidate) {
  const Evidence& e = candidate.evidence;
  const auto term = [](const char* name, auto value) { return EvidenceTerm{name, static_cast<double>(value)}; };
  return {term("edges", e.edges),
          term("contrast", e.contrast),
          term("distinct", e.distinct),
          term("on", e.surface.on),
          term("through", e.surface.through),
          term("before", e.surface.before),
          term("drop", e.surface.drop),
          term("level", e.surface.level),
          term("faces", e.faces),
          term("overrun", e.overrun),
          term("support", e.support),
          term("inside", e.inside),
          term("visible_px", e.visible_px),
          term("supported_edges", e.supported_edges),
          term("supported_faces", e.supported_faces),
          term("rms_px", candidate.pose.rms_px),
          term("inliers", candidate.pose.inliers)};
}

}  // namespace wirepose::evaluation
