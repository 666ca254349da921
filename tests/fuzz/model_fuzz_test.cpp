// Twenty thousand mutated model files in every test run; libFuzzer (model_fuzzer.cpp) searches
// deeper.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>

#include "tests/fuzz/model_fuzz_target.h"
#include "tests/mesh/test_meshes.h"
#include "tests/tools/model_test_options.h"

namespace wirepose {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::uint32_t kInteresting[] = {0,          1,          0x7F,       0xFF,       0xFFFF,     0x7FFFFFFF,
                                          0x80000000, 0xFFFFFFFF, 0x7FC00000, 0x7F800000, 0xFF800000, 0x3F800000};

// One to six edits: a byte, a telling word, a block copied over another, or an end cut off or
// appended.
void Mutate(std::mt19937& random, Bytes& file) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  // Half of the edits go to the header, which is a hundredth of the file and holds the section
  // table.
  const auto place = [&] { return below(2) == 0 ? below(sizeof(ModelFileHeader)) : below(file.size()); };
  for (std::size_t edits = 1 + below(6); edits > 0 && file.size() > sizeof(ModelFileHeader); --edits) {
    const std::size_t at = place();
    switch (below(8)) {
      case 0:
        file[at] = static_cast<std::byte>(random());
        break;
      case 1:
        file[at] ^= static_cast<std::byte>(1U << below(8));
        break;
      case 2:
      case 3:
      case 4: {
        const std::size_t word = std::min(at, file.size() - 4) / 4 * 4;
        std::memcpy(file.data() + word, &kInteresting[below(std::size(kInteresting))], 4);
        break;
      }
      case 5: {
        const std::size_t from = below(file.size() - 32);
        std::memmove(file.data() + std::min(at, file.size() - 32), file.data() + from, 32);
        break;
      }
      case 6:
        file[at / 2 * 2] = static_cast<std::byte>(below(16));
        break;
      default:
        if (below(8) == 0) file.resize(std::max(sizeof(ModelFileHeader), file.size() - below(200)));
        break;
    }
  }
}

TEST(ModelFuzz, MutatedFilesAreRefusedOrConsistent) {
  const Bytes seeds[] = {
      tools::CompileModel(testing::BoxMesh(0.3, 0.2, 0.15), testing::TestOptions()).value().bytes,
      tools::CompileModel(testing::BoxMesh(0.1, 0.1, 0.1), testing::TestOptions()).value().bytes,
      tools::CompileModel(testing::TwoPartMesh(), testing::TestOptions()).value().bytes,
  };
  std::mt19937 random(20240611);
  int accepted = 0, refused = 0;
  for (int i = 0; i < 20000; ++i) {
    Bytes file = seeds[i % std::size(seeds)];
    Mutate(random, file);
    const auto outcome = testing::ParseAnyBytes(file, i % 16 != 0);
    ASSERT_EQ(outcome.inconsistency, nullptr) << "mutation " << i;
    (outcome.accepted ? accepted : refused) += 1;
  }
  // The mutations must reach behind the first checks, and most must do damage.
  EXPECT_GT(accepted, 200);
  EXPECT_GT(refused, 5000);
}

TEST(ModelFuzz, RandomBytesAreRefused) {
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    Bytes file(random() % 600);
    for (std::byte& b : file) b = static_cast<std::byte>(random());
    EXPECT_FALSE(testing::ParseAnyBytes(file, i % 2 == 0).accepted);
  }
}

}  // namespace
}  // namespace wirepose
