// Preloaded into wireposed by heap_test: counts its calls of the heap and its page faults from its first sign of life
// to systemd's watchdog, which follows the first frame, until it tells that it stops, and writes them to the file that
// WIREPOSE_HEAP_COUNT names: "main N others N minor_faults N major_faults N", then "thread NAME N" for each thread that
// called and still runs.
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

struct Thread {
  pid_t id = 0;
  std::atomic<long> calls{0};
  long at_begin = 0;
};
constexpr int kMaxThreads = 64;  // later ones count among the others only
Thread g_threads[kMaxThreads];
std::atomic<int> g_thread_count{0};
// Not the kind of thread storage whose first use allocates.
__attribute__((tls_model("initial-exec"))) thread_local Thread* t_self = nullptr;
__attribute__((tls_model("initial-exec"))) thread_local bool t_known = false;

void Count() {
  std::atomic<long>& counter = gettid() == getpid() ? g_main : g_others;
  counter.fetch_add(1, std::memory_order_relaxed);
  if (!t_known) {
    t_known = true;
    if (const int index = g_thread_count.fetch_add(1); index < kMaxThreads) {
      t_self = &g_threads[index];
      t_self->id = gettid();
    }
  }
  if (t_self != nullptr) t_self->calls.fetch_add(1, std::memory_order_relaxed);
}

int KnownThreads() { return g_thread_count < kMaxThreads ? g_thread_count.load() : kMaxThreads; }

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

void Begin() {
  g_begin = Now();
  for (int i = 0; i < KnownThreads(); ++i) g_threads[i].at_begin = g_threads[i].calls;
  g_begun = true;
}

void ReportThread(const Thread& thread, std::FILE* out) {
  char path[64], name[32] = "";
  std::snprintf(path, sizeof path, "/proc/self/task/%d/comm", static_cast<int>(thread.id));
  std::FILE* const comm = std::fopen(path, "r");
  if (comm == nullptr) return;  // has ended
  if (std::fscanf(comm, "%31s", name) == 1) std::fprintf(out, "thread %s %ld\n", name, thread.calls - thread.at_begin);
  std::fclose(comm);
}

void Report() {
  const Use end = Now();
  const char* const file = std::getenv("WIREPOSE_HEAP_COUNT");
  std::FILE* const out = file == nullptr ? nullptr : std::fopen(file, "w");
  if (out == nullptr) return;
  std::fprintf(out, "main %ld others %ld minor_faults %ld major_faults %ld\n", end.main - g_begin.main,
               end.others - g_begin.others, end.minor_faults - g_begin.minor_faults,
               end.major_faults - g_begin.major_faults);
  for (int i = 0; i < KnownThreads(); ++i) ReportThread(g_threads[i], out);
  std::fclose(out);
}

}  // namespace

extern "C" {
// In place of libsystemd's.
int sd_notify(int, const char* state) {
  if (!g_begun && std::strncmp(state, "WATCHDOG=1", 10) == 0) Begin();
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
