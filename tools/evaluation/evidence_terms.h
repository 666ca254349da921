// The evidence of a candidate by name: what logs and reports show of it.
#ifndef WIREPOSE_TOOLS_EVALUATION_EVIDENCE_TERMS_H_
#define WIREPOSE_TOOLS_EVALUATION_EVIDENCE_TERMS_H_

#include <vector>

#include "stages/selection.h"

namespace wirepose::evaluation {

struct EvidenceTerm {
  const char* name;
  double value;
};

// All terms in one order, the same for every candidate: those of the evidence, then rms_px and inliers of the pose.
std::vector<EvidenceTerm> EvidenceTerms(const Candidate& candidate);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_EVIDENCE_TERMS_H_
