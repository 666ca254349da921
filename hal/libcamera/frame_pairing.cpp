#include "hal/libcamera/frame_pairing.h"

#include <algorithm>

namespace wirepose::hal {

void FramePairing::Add(std::size_t eye, const EyeFrame& frame) { waiting_[eye].push_back(frame); }

void FramePairing::Clear() {
  for (Waiting& frames : waiting_) frames.clear();
}

void FramePairing::DropFront(std::size_t eye, FreedSlots& freed) {
  Waiting& frames = waiting_[eye];
  freed.push_back({eye, frames.front().slot});
  std::move(frames.begin() + 1, frames.end(), frames.begin());
  frames.pop_back();
}

std::optional<FramePair> FramePairing::TakeNewest(FreedSlots& freed) {
  std::optional<FramePair> newest;
  while (!waiting_[0].empty() && !waiting_[1].empty()) {
    const EyeFrame left = waiting_[0].front(), right = waiting_[1].front();
    const auto distance = right.time - left.time;
    if (distance > max_distance_ || distance < -max_distance_) {
      DropFront(distance > std::chrono::nanoseconds{0} ? 0 : 1, freed);  // the older one's partner did not come
      ++unpaired_;
      continue;
    }
    if (newest) {
      freed.push_back({0, newest->left.slot});
      freed.push_back({1, newest->right.slot});
    }
    newest = FramePair{left, right};
    FreedSlots of_the_pair;  // leased now
    DropFront(0, of_the_pair);
    DropFront(1, of_the_pair);
  }
  for (std::size_t eye = 0; eye < 2; ++eye) {
    // Were all buffers to wait for the other eye, this camera would stand still.
    while (waiting_[eye].size() + 1 >= kCameraBuffers) {
      DropFront(eye, freed);
      ++unpaired_;
    }
  }
  return newest;
}

}  // namespace wirepose::hal
