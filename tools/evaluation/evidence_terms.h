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

// The terms that the score reads, in its order (TermsOf), the same for every candidate.
std::vector<EvidenceTerm> NamedTerms(const Candidate& candidate);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_EVIDENCE_TERMS_H_
