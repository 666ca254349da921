// libFuzzer target for ParseModel. Build with Clang and -DWIREPOSE_FUZZ=ON, then: model_fuzzer
// build/.../models
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/model_fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  for (const bool seal : {false, true}) {
    const auto outcome = wirepose::testing::ParseAnyBytes(bytes, seal);
    if (outcome.inconsistency == nullptr) continue;
    std::fprintf(stderr, "accepted an inconsistent model: %s\n", outcome.inconsistency);
    std::abort();
  }
  return 0;
}
