// Options for compiling the meshes of tests/mesh/test_meshes.h.
#ifndef WIREPOSE_TESTS_TOOLS_MODEL_TEST_OPTIONS_H_
#define WIREPOSE_TESTS_TOOLS_MODEL_TEST_OPTIONS_H_

#include <cstdint>

#include "tools/model_compiler/model_compiler.h"

namespace wirepose::testing {

inline tools::CompileOptions TestOptions(std::uint32_t id = 7) {
  tools::CompileOptions options;
  options.id = id;
  options.name = "test object";
  return options;
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_TOOLS_MODEL_TEST_OPTIONS_H_
