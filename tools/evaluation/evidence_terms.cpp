#include "tools/evaluation/evidence_terms.h"

namespace wirepose::evaluation {

std::vector<EvidenceTerm> NamedTerms(const Candidate& candidate) {
  const EvidenceTerms values = TermsOf(candidate.evidence);
  std::vector<EvidenceTerm> terms;
  for (std::size_t i = 0; i < values.size(); ++i) {
    terms.push_back({EvidenceTermNames()[i], static_cast<double>(values[i])});
  }
  return terms;
}

}  // namespace wirepose::evaluation
