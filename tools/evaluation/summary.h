// An evaluation as a table for people.
#ifndef WIREPOSE_TOOLS_EVALUATION_SUMMARY_H_
#define WIREPOSE_TOOLS_EVALUATION_SUMMARY_H_

#include <string>

#include "tools/evaluation/evaluate.h"

namespace wirepose::evaluation {

// One row an object and one for all, false alarms of frames without objects, stage times, lists
// that overflowed.
std::string Summarize(const Evaluation& evaluation);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_SUMMARY_H_
