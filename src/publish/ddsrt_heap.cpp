// Cyclone's allocation functions, defined in the executable: libddsc calls them through its procedure linkage table, so
// these take precedence over its own (measured with Cyclone DDS 0.10.2, security plug-ins included; tests/publish/
// pool_test.cpp fails where that does not hold). Link this room into a program to give DDS its static pool.
#include <dds/ddsrt/heap.h>

#include <cstring>

#include "publish/dds_pool.h"

namespace {

void* Zeroed(std::size_t count, std::size_t size) {
  std::size_t bytes = 0;
  if (__builtin_mul_overflow(count, size, &bytes)) bytes = static_cast<std::size_t>(-1);  // fits nowhere
  void* const block = wirepose::DdsPoolAlloc(bytes);
  std::memset(block, 0, bytes);
  return block;
}

void* Resized(void* block, std::size_t bytes) {
  return block == nullptr ? wirepose::DdsPoolAlloc(bytes) : wirepose::DdsPoolResize(block, bytes);
}

}  // namespace

extern "C" {
void* ddsrt_malloc(size_t size) { return wirepose::DdsPoolAlloc(size); }
void* ddsrt_malloc_s(size_t size) { return wirepose::DdsPoolAlloc(size); }
void* ddsrt_calloc(size_t count, size_t size) { return Zeroed(count, size); }
void* ddsrt_calloc_s(size_t count, size_t size) { return Zeroed(count, size); }
void* ddsrt_realloc(void* memory, size_t size) { return Resized(memory, size); }
void* ddsrt_realloc_s(void* memory, size_t size) { return Resized(memory, size); }
void ddsrt_free(void* memory) {
  if (memory != nullptr) wirepose::DdsPoolFree(memory);
}
}
