// Preloaded into wireposed by heap_test: counts its calls of the heap and its page faults from its first sign of life
// to systemd's watchdog, which follows the first frame, until it tells that it stops, and writes them to the file that
// WIREPOSE_HEAP_COUNT names: "main N others N minor_faults N major_faults N".
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

// glibc's own allocator under its internal names; operator new and the other kinds go through these.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {

std::atomic<long> g_main{0}, g_others{0};

void Count() {
  std::atomic<long>& counter = gettid() == getpid() ? g_main : g_others;
  counter.fetch_add(1, std::memory_order_relaxed);
}

struct Use {
  long main, others, minor_faults, major_faults;
};

Use Now() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {g_main, g_others, usage.ru_minflt, usage.ru_majflt};
}

Use g_begin{};
bool g_begun = false;

void Report() {
  const Use end = Now();
  const char* const file = std::getenv("WIREPOSE_HEAP_COUNT");
  std::FILE* const out = file == nullptr ? nullptr : std::fopen(file, "w");
  if (out == nullptr) return;
  std::fprintf(out, "main %ld others %ld minor_faults %ld major_faults %ld\n", end.main - g_begin.main,
               end.others - g_begin.others, end.minor_faults - g_begin.minor_faults,
               end.major_faults - g_begin.major_faults);
  std::fclose(out);
}

}  // namespace

extern "C" {
// In place of libsystemd's.
int sd_notify(int, const char* state) {
  if (!g_begun && std::strncmp(state, "WATCHDOG=1", 10) == 0) {
    g_begin = Now();
    g_begun = true;
  }
  if (std::strncmp(state, "STOPPING=1", 10) == 0) Report();
  return 0;
}

void* malloc(std::size_t size) {
  Count();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  Count();
  return __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) {
  Count();
  return __libc_realloc(p, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  Count();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) {
  Count();
  *p = __libc_memalign(alignment, size);
  return *p == nullptr ? ENOMEM : 0;
}
}
