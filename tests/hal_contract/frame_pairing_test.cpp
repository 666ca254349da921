#include "hal/libcamera/frame_pairing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace wirepose::hal {
namespace {

using std::chrono::milliseconds;

EyeFrame FrameOf(std::uint32_t slot, int time_ms) {
  return {slot, static_cast<std::uint32_t>(time_ms / 33), milliseconds(time_ms), false};
}

class FramePairingTest : public ::testing::Test {
 protected:
  FramePairing pairing_{milliseconds(16)};
  FreedSlots freed_;
};

TEST_F(FramePairingTest, NothingWithoutBothEyes) {
  EXPECT_FALSE(pairing_.TakeNewest(freed_));
  pairing_.Add(0, FrameOf(0, 100));
  EXPECT_FALSE(pairing_.TakeNewest(freed_));
  EXPECT_TRUE(freed_.empty()) << "its partner may still come";
  pairing_.Add(1, FrameOf(2, 103));
  const auto pair = pairing_.TakeNewest(freed_);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->left.slot, 0U);
  EXPECT_EQ(pair->right.slot, 2U);
  EXPECT_TRUE(freed_.empty());
  EXPECT_EQ(pairing_.unpaired(), 0U);
}

TEST_F(FramePairingTest, ALostFrameDoesNotShiftThePairs) {
  pairing_.Add(0, FrameOf(0, 100));
  pairing_.Add(0, FrameOf(1, 133));
  pairing_.Add(1, FrameOf(0, 134));  // the one at 100 ms was lost
  const auto pair = pairing_.TakeNewest(freed_);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->left.slot, 1U);
  ASSERT_EQ(freed_.size(), 1U);
  EXPECT_EQ(freed_[0].eye, 0U);
  EXPECT_EQ(freed_[0].slot, 0U);
  EXPECT_EQ(pairing_.unpaired(), 1U);
}

TEST_F(FramePairingTest, ASlowCallerGetsTheNewestPair) {
  for (std::uint32_t i = 0; i < 3; ++i) {
    pairing_.Add(0, FrameOf(i, 100 + 33 * static_cast<int>(i)));
    pairing_.Add(1, FrameOf(i, 101 + 33 * static_cast<int>(i)));
  }
  const auto pair = pairing_.TakeNewest(freed_);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->left.slot, 2U);
  EXPECT_EQ(freed_.size(), 4U);
  EXPECT_EQ(pairing_.unpaired(), 0U) << "they had partners";
}

TEST_F(FramePairingTest, ACameraWhosePartnerIsSilentKeepsABuffer) {
  for (std::uint32_t i = 0; i < 4; ++i) pairing_.Add(0, FrameOf(i, 100 + 33 * static_cast<int>(i)));
  EXPECT_FALSE(pairing_.TakeNewest(freed_));
  EXPECT_EQ(freed_.size(), 2U) << "at most two wait";
}

// One camera side by side gives both eyes one buffer: pairs are of one slot, at one time, and no frame lacks a partner.
TEST_F(FramePairingTest, SideBySideFramesPairWithThemselves) {
  std::array<bool, kCameraBuffers> with_camera{true, true, true, true};
  for (int t = 0; t < 50; ++t) {
    const int arrived = t % 3;  // none, one, or two since the caller last asked
    for (int k = 0; k < arrived; ++k) {
      const auto slot = std::find(with_camera.begin(), with_camera.end(), true);
      ASSERT_NE(slot, with_camera.end()) << "a buffer was lost";
      *slot = false;
      const EyeFrame frame = FrameOf(static_cast<std::uint32_t>(slot - with_camera.begin()), 66 * t + 33 * k);
      for (std::size_t eye = 0; eye < 2; ++eye) pairing_.Add(eye, frame);
    }
    FreedSlots freed;
    const auto pair = pairing_.TakeNewest(freed);
    ASSERT_EQ(pair.has_value(), arrived > 0);
    for (const FreedSlot& f : freed) {
      if (f.eye == 1) continue;  // the same buffer once more
      ASSERT_FALSE(with_camera[f.slot]) << "given back twice";
      with_camera[f.slot] = true;
    }
    if (!pair) continue;
    EXPECT_EQ(pair->left.slot, pair->right.slot);
    EXPECT_EQ(pair->left.time, pair->right.time);
    EXPECT_EQ(pair->left.time, milliseconds(66 * t + 33 * (arrived - 1))) << "the newest";
    with_camera[pair->left.slot] = true;  // the lease ends
  }
  EXPECT_EQ(pairing_.unpaired(), 0U);
}

// Random losses, delays and order of arrival: a pair is never farther apart than allowed, no slot is lost or used
// twice.
TEST_F(FramePairingTest, RandomStreamsKeepTheBooks) {
  std::mt19937 random(9);
  for (int round = 0; round < 200; ++round) {
    FramePairing pairing(milliseconds(16));
    std::array<std::array<bool, kCameraBuffers>, 2> with_camera;
    for (auto& eye : with_camera) eye.fill(true);
    const int skew = static_cast<int>(random() % 30) - 15;
    const auto give_back = [&](std::size_t eye, std::uint32_t slot) {
      ASSERT_FALSE(with_camera[eye][slot]) << "twice";
      with_camera[eye][slot] = true;
    };
    for (int t = 0; t < 100; ++t) {
      for (std::size_t eye = 0; eye < 2; ++eye) {
        const auto slot = std::find(with_camera[eye].begin(), with_camera[eye].end(), true);
        if (random() % 5 == 0 || slot == with_camera[eye].end()) continue;  // lost
        *slot = false;
        pairing.Add(
            eye, FrameOf(static_cast<std::uint32_t>(slot - with_camera[eye].begin()), 33 * t + (eye == 1 ? skew : 0)));
      }
      if (random() % 3 == 0) continue;  // the caller is busy
      FreedSlots freed;
      const auto pair = pairing.TakeNewest(freed);
      for (const FreedSlot& f : freed) give_back(f.eye, f.slot);
      if (!pair) continue;
      ASSERT_EQ(pair->right.time - pair->left.time, milliseconds(skew));
      give_back(0, pair->left.slot);
      give_back(1, pair->right.slot);
      for (const auto& eye : with_camera) ASSERT_GE(std::count(eye.begin(), eye.end(), true), 2);
    }
  }
}

}  // namespace
}  // namespace wirepose::hal
