#include "publish/dds_pool.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <mutex>

namespace wirepose {
namespace {

// Constant initialization: Cyclone may allocate before main.
constinit std::mutex g_mutex;
constinit FixedHeap g_heap;
constinit std::size_t g_size = kDefaultDdsPoolBytes;
constinit bool g_used = false;
constexpr std::size_t kPage = 4096;  // or a multiple, where pages are larger: then a little less is given back
alignas(kPage) std::byte g_storage[kMaxDdsPoolBytes];
static_assert(kMaxDdsPoolBytes % kPage == 0 && kMinDdsPoolBytes % kPage == 0);

// The heap, made ready by its first user. The caller holds the mutex.
FixedHeap& Heap() {
  if (!g_used) {
    g_heap.Reset({g_storage, g_size});
    // Out of reach, the part that was not chosen costs no memory, also when all of the process is locked into it.
    // It costs some where the system refuses; that is all.
#ifndef __SANITIZE_ADDRESS__  // the leak check reads all static memory
    (void)mprotect(g_storage + g_size, kMaxDdsPoolBytes - g_size, PROT_NONE);
#endif
  }
  g_used = true;
  return g_heap;
}

// Neither allocates nor throws: there is no memory left.
[[noreturn]] void EndForFullPool(std::size_t bytes) {
  char text[300];
  const int size = std::snprintf(
      text, sizeof text,
      "wirepose: the DDS pool is full: %zu of %zu KiB in use, %zu more bytes wanted; raise dds.pool_kib in the "
      "configuration, or let fewer programs join the domain (docs/dds.md, memory)\n",
      g_heap.use().used >> 10, g_heap.use().capacity >> 10, bytes);
  if (size > 0) {
    (void)!write(STDERR_FILENO, text, std::min(static_cast<std::size_t>(size), sizeof text - 1));
  }
  std::abort();
}

}  // namespace

bool SetDdsPoolSize(std::size_t bytes) {
  const std::scoped_lock lock(g_mutex);
  if (g_used) return false;
  g_size = std::clamp(bytes, kMinDdsPoolBytes, kMaxDdsPoolBytes) / kPage * kPage;
  return true;
}

HeapUse DdsPoolUse() {
  const std::scoped_lock lock(g_mutex);
  return g_heap.use();
}

void* DdsPoolAlloc(std::size_t bytes) {
  const std::scoped_lock lock(g_mutex);
  void* const block = Heap().Alloc(bytes);
  if (block == nullptr) EndForFullPool(bytes);
  return block;
}

void* DdsPoolResize(void* block, std::size_t bytes) {
  const std::scoped_lock lock(g_mutex);
  void* const moved = Heap().Resize(block, bytes);
  if (moved == nullptr) EndForFullPool(bytes);
  return moved;
}

void DdsPoolFree(void* block) {
  const std::scoped_lock lock(g_mutex);
  Heap().Free(block);
}

}  // namespace wirepose
