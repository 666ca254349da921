// The memory that Cyclone DDS works in: a static pool instead of the heap of libc.
//
// A program gets it by linking wirepose_dds_pool, which defines Cyclone's allocation functions (ddsrt_malloc and its
// like) in the executable, where they take precedence over the library's. Without it everything below reports zero.
#ifndef WIREPOSE_PUBLISH_DDS_POOL_H_
#define WIREPOSE_PUBLISH_DDS_POOL_H_

#include "publish/fixed_heap.h"

namespace wirepose {

// What the configuration may choose, and the default. 2 MiB serves twenty peers, also when they all arrive at once on a
// busy machine; every participant, reader and writer in the domain costs some (docs/dds.md). The array is part of the
// program; what is not chosen of it costs no memory.
inline constexpr std::size_t kMaxDdsPoolBytes = std::size_t{8} << 20;
inline constexpr std::size_t kMinDdsPoolBytes = std::size_t{256} << 10;
inline constexpr std::size_t kDefaultDdsPoolBytes = std::size_t{2} << 20;
inline constexpr std::size_t kDefaultSecuredDdsPoolBytes = std::size_t{4} << 20;

// Sets how much of the array may be used, kMinDdsPoolBytes to kMaxDdsPoolBytes. Has an effect only before the first use
// of DDS in the process: returns false afterwards.
bool SetDdsPoolSize(std::size_t bytes);

// Any thread. Capacity 0: the program has no pool, Cyclone uses the heap.
HeapUse DdsPoolUse();

// For the definitions of ddsrt_malloc and its like. Thread-safe. When the pool is full they end the program with a line
// on stderr that says what to do: Cyclone cannot go on without memory, and a service is started anew.
void* DdsPoolAlloc(std::size_t bytes);
void* DdsPoolResize(void* block, std::size_t bytes);
void DdsPoolFree(void* block);

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_DDS_POOL_H_
