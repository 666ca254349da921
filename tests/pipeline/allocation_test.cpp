// No call of the recognizer touches the heap. This program replaces malloc and its kin (with the
// sanitizers: hooks them) and counts.
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <new>

#include "pipeline/recognizer.h"
#include "tests/golden/golden_frames.h"

namespace {
std::atomic<long> g_allocations{0};
}

#ifdef __SANITIZE_ADDRESS__
// Of the sanitizers' public interface; GCC's packages lack the header.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*)(const volatile void*, std::size_t),
                                                         void (*)(const volatile void*));
namespace {
[[maybe_unused]] const int kHooks = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { ++g_allocations; }, [](const volatile void*) {});
}
#else
// glibc's own allocator under its internal names; operator new goes through malloc.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  ++g_allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++g_allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) {
  ++g_allocations;
  return __libc_realloc(p, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++g_allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) {
  ++g_allocations;
  *p = __libc_memalign(alignment, size);
  return *p == nullptr ? ENOMEM : 0;
}
}
#endif

namespace wirepose {
namespace {

template <typename Call>
long AllocationsIn(const Call& call) {
  const long before = g_allocations;
  call();
  return g_allocations - before;
}

TEST(Allocation, CounterSeesEveryKind) {
  std::vector<void*> kept;
  kept.reserve(8);
  EXPECT_EQ(AllocationsIn([&] { kept.push_back(std::malloc(10)); }), 1);
  EXPECT_EQ(AllocationsIn([&] { kept.push_back(std::calloc(3, 4)); }), 1);
  EXPECT_EQ(AllocationsIn([&] { kept.push_back(std::aligned_alloc(64, 128)); }), 1);
  EXPECT_EQ(AllocationsIn([&] { kept.push_back(::operator new(16)); }), 1);
  ::operator delete(kept.back());
  kept.pop_back();
  for (void* p : kept) std::free(p);
}

TEST(Allocation, NoneInTheRecognizer) {
  static Recognizer recognizer;
  static RecognitionResult result;
  const auto models = testing::GoldenModels();
  const StereoCalibration calibration = testing::GoldenCalibration();
  EXPECT_EQ(AllocationsIn([&] { (void)recognizer.Configure(calibration); }), 0);
  EXPECT_EQ(AllocationsIn([&] {
              for (const auto& model : models) (void)recognizer.AddModel(model.View());
            }),
            0);
  for (int i = 0; i < testing::kGoldenFrames; ++i) {
    const testing::StereoImages frame = testing::GoldenFrame(i);
    RecognizerError error{};
    EXPECT_EQ(
        AllocationsIn([&] { error = recognizer.Process(frame.left.view(), frame.right.view(), nullptr, result); }), 0);
    EXPECT_EQ(error, RecognizerError::kOk);
  }
  EXPECT_EQ(AllocationsIn([&] { recognizer.ClearModels(); }), 0);
}

}  // namespace
}  // namespace wirepose
