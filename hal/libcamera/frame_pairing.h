// Which left frame belongs to which right frame: by capture time, never by count, because a lost frame shifts counts.
#ifndef WIREPOSE_HAL_LIBCAMERA_FRAME_PAIRING_H_
#define WIREPOSE_HAL_LIBCAMERA_FRAME_PAIRING_H_

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "base/fixed_vector.h"

namespace wirepose::hal {

inline constexpr std::uint32_t kCameraBuffers =
    4;  // of each camera: one exposed, one or two waiting, one or two leased

// A frame that one camera has finished.
struct EyeFrame {
  std::uint32_t slot = 0;      // buffer, below kCameraBuffers
  std::uint32_t sequence = 0;  // the camera's own count, with the frames it lost
  std::chrono::nanoseconds time{0};
  bool damaged = false;  // the camera says so
};

struct FramePair {
  EyeFrame left, right;
};

// A buffer that goes back to its camera.
struct FreedSlot {
  std::size_t eye = 0;  // 0 left, 1 right
  std::uint32_t slot = 0;
};
using FreedSlots = FixedVector<FreedSlot, 2 * kCameraBuffers>;

// Holds finished frames until their partners come. At most kCameraBuffers an eye, since there are no more buffers. Not
// thread safe; no allocation; every call O(kCameraBuffers).
class FramePairing {
 public:
  // Frames farther apart than this belong to different moments: half the frame period.
  explicit FramePairing(std::chrono::nanoseconds max_distance) : max_distance_(max_distance) {}

  // Frames of each eye come in the order of time.
  void Add(std::size_t eye, const EyeFrame& frame);

  // The newest pair there is. Older pairs, and frames whose partner can no longer come, are given up: their slots are
  // appended to `freed`. A frame without partner that may still come stays, unless the eye has no free buffer left.
  [[nodiscard]] std::optional<FramePair> TakeNewest(FreedSlots& freed);

  // Forgets all frames, without freeing.
  void Clear();

  // Frames given up because their partner was lost.
  [[nodiscard]] std::uint64_t unpaired() const { return unpaired_; }

 private:
  using Waiting = FixedVector<EyeFrame, kCameraBuffers>;

  void DropFront(std::size_t eye, FreedSlots& freed);

  std::chrono::nanoseconds max_distance_;
  std::array<Waiting, 2> waiting_;  // oldest first
  std::uint64_t unpaired_ = 0;
};

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_LIBCAMERA_FRAME_PAIRING_H_
