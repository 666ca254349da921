// The property that model fuzzing tests; shared by libFuzzer and the regression runner.
#ifndef WIREPOSE_TESTS_FUZZ_MODEL_FUZZ_TARGET_H_
#define WIREPOSE_TESTS_FUZZ_MODEL_FUZZ_TARGET_H_

#include <span>
#include <vector>

#include "model/model_parser.h"
#include "tests/model/model_consistency.h"
#include "tools/model_compiler/model_writer.h"

namespace wirepose::testing {

struct FuzzOutcome {
  bool accepted = false;
  const char* inconsistency = nullptr;  // of an accepted view: a bug of the parser
};

// Parses any bytes. With `seal`, size and checksum are made right first, so that the deeper checks
// are reached.
inline FuzzOutcome ParseAnyBytes(std::span<const std::byte> bytes, bool seal) {
  std::vector<std::byte> file(bytes.begin(), bytes.end());
  if (seal && file.size() >= sizeof(ModelFileHeader)) tools::SealModel(file);
  const auto model = ParseModel(file);
  if (!model) return {};
  return {true, FindInconsistency(*model)};
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_FUZZ_MODEL_FUZZ_TARGET_H_
