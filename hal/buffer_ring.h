// The fixed set of stereo buffers behind the software backends (replay, simulated).
#ifndef WIREPOSE_HAL_BUFFER_RING_H_
#define WIREPOSE_HAL_BUFFER_RING_H_

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/check.h"
#include "base/image_view.h"

namespace wirepose::hal {

// `kCount` pairs of images, allocated once. One thread takes buffers, any thread returns them.
template <std::uint32_t kCount>
class BufferRing {
 public:
  static constexpr std::uint32_t kBuffers = kCount;

  // Allocates all pixels; every buffer is free then.
  void Allocate(int width, int height) {
    width_ = width;
    height_ = height;
    const std::size_t bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    for (Buffer& buffer : buffers_) {
      buffer.left.assign(bytes, 0);
      buffer.right.assign(bytes, 0);
      buffer.taken.store(false, std::memory_order_relaxed);
    }
  }

  // Frees the pixels. Halts when a buffer is still taken: somebody would read freed memory.
  void Free() {
    for (Buffer& buffer : buffers_) {
      Check(!buffer.taken.load(std::memory_order_acquire));
      buffer.left = {};
      buffer.right = {};
    }
  }

  // A free buffer, taken for the caller; nothing when all are taken. O(kCount).
  [[nodiscard]] std::optional<std::uint32_t> Take() {
    for (std::uint32_t i = 0; i < kCount; ++i) {
      if (!buffers_[i].taken.exchange(true, std::memory_order_acquire)) return i;
    }
    return std::nullopt;
  }

  void Return(std::uint32_t i) {
    Check(i < kCount);
    buffers_[i].taken.store(false, std::memory_order_release);
  }

  [[nodiscard]] MutableImageView left(std::uint32_t i) { return View(buffers_[i].left); }
  [[nodiscard]] MutableImageView right(std::uint32_t i) { return View(buffers_[i].right); }

 private:
  struct Buffer {
    std::vector<std::uint8_t> left, right;
    std::atomic<bool> taken{false};
  };

  MutableImageView View(std::vector<std::uint8_t>& pixels) const { return {pixels.data(), width_, height_, width_}; }

  std::array<Buffer, kCount> buffers_;
  int width_ = 0, height_ = 0;
};

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_BUFFER_RING_H_
