// A small data set of recorded frames with every outcome in it: hits, misses and false alarms.
#ifndef WIREPOSE_TESTS_TOOLS_REPORT_DATASET_H_
#define WIREPOSE_TESTS_TOOLS_REPORT_DATASET_H_

#include <filesystem>
#include <string>

namespace wirepose::evaluation::testing {

// Text that would run or break a page that took it for markup. As long as a model's name may be.
inline constexpr const char* kHostileName = "</script><img src=x onerror=1>";

struct CommandOutcome {
  int status = -1;
  std::string out, err;
};

// Runs the shell command in `folder`.
CommandOutcome RunIn(const std::filesystem::path& folder, const std::string& command);

std::string TextOf(const std::filesystem::path& file);

// Writes FOLDER/set with the golden frames and FOLDER/models with their models, the book under kHostileName. Truth is
// made of what the recognizer reports there: of every three detections one is a true instance, one lies beside a true
// instance (a miss and a false alarm), one is a false alarm. Frame 0 also has a refrigerator at 3 m, for which there
// is no model. Fails the test when something cannot be made.
void WriteReportDataset(const std::filesystem::path& folder);

}  // namespace wirepose::evaluation::testing

#endif  // WIREPOSE_TESTS_TOOLS_REPORT_DATASET_H_
