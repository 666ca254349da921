#include "live_table.h"

#include <gtest/gtest.h>

#include <cstring>

namespace wirepose::cli {
namespace {

using namespace std::chrono_literals;

constexpr LiveTable::Time kNow = 1'700'000'000s;

class LiveTableTest : public ::testing::Test {
 protected:
  // A frame with objects of these tracks (0: not tracked) of model 3, taken `latency` ago.
  void Frame(std::uint64_t sequence, const std::vector<std::uint32_t>& tracks, LiveTable::Time now,
             LiveTable::Time latency = 20ms) {
    std::vector<wirepose_Detection> detections(tracks.size());
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      wirepose_Detection& d = detections[i];
      std::strcpy(d.name, "book");
      d.model_id = 3;
      d.track_id = tracks[i];
      d.pose.position_m[0] = 0.125 + static_cast<double>(i);
      d.pose.orientation_xyzw[3] = 1;
      d.covariance[0] = d.covariance[7] = d.covariance[14] = 3e-6;  // 3 mm
      d.score = 0.875F;
    }
    wirepose_Recognition message{};
    message.frame_sequence = sequence;
    message.stamp_ns = (now - latency).count();
    message.detections = {static_cast<std::uint32_t>(detections.size()), static_cast<std::uint32_t>(detections.size()),
                          detections.data(), false};
    table_.Add(message, now);
  }
  [[nodiscard]] std::size_t Rows(LiveTable::Time now) const {
    const std::string text = table_.Draw(now, 200);
    std::size_t rows = 0;
    for (std::size_t at = 0; (at = text.find("book ", at)) != std::string::npos; ++at) ++rows;
    return rows;
  }

  LiveTable table_;
};

TEST_F(LiveTableTest, ShowsWhatAMessageSays) {
  Frame(7, {42}, kNow);
  const std::string text = table_.Draw(kNow, 200);
  for (const char* const part : {"frame 7", "latency 20.0 ms", "book", " 42 ", "0.125", " 3.0 ", "0.875"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in\n" << text;
  }
  EXPECT_NE(text.find("health: nothing heard yet"), std::string::npos);
}

TEST_F(LiveTableTest, HealthLineTellsOfTheEyes) {
  wirepose_Health health{};
  health.state = wirepose_RUNNING;
  health.rows = {wirepose_ROWS_VARYINGLY_OFF, 20, 0.5F, 0.25F, 0.125F, 0.75F};
  table_.Add(health, kNow);
  EXPECT_NE(table_.Draw(kNow, 200).find("rows varyingly_off (0.75 px)"), std::string::npos) << table_.Draw(kNow, 200);
}

TEST_F(LiveTableTest, TracksAreOneRowAndOthersOneEach) {
  Frame(1, {42, 0, 0}, kNow);
  Frame(2, {42, 0, 0}, kNow + 33ms);
  EXPECT_EQ(Rows(kNow + 33ms), 3u);
}

TEST_F(LiveTableTest, WhatIsGoneIsForgotten) {
  Frame(1, {42}, kNow);
  Frame(2, {}, kNow + 1s);
  EXPECT_EQ(Rows(kNow + 1s), 1u) << "an object that blinks stays for a while, with its age";
  EXPECT_EQ(Rows(kNow + 3s), 0u);
}

TEST_F(LiveTableTest, RateAndLosses) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    if (i != 50) Frame(i, {}, kNow + i * 40ms);
  }
  EXPECT_NEAR(table_.Rate(kNow + 60 * 40ms), 24, 1.5);
  EXPECT_NE(table_.Draw(kNow + 60 * 40ms, 200).find("1 lost"), std::string::npos);
  EXPECT_EQ(table_.Rate(kNow + 10s), 0);
}

TEST_F(LiveTableTest, LatencyOfAnotherClockIsNotShown) {
  Frame(1, {}, kNow, 1h);
  EXPECT_FALSE(table_.Latency());
  EXPECT_NE(table_.Draw(kNow, 200).find("latency unknown"), std::string::npos);
}

TEST_F(LiveTableTest, LinesFitTheTerminalAndNotesGo) {
  Frame(1, {1, 2, 3}, kNow);
  table_.Note("the publisher is gone", kNow);
  const std::string text = table_.Draw(kNow + 1s, 40);
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    EXPECT_LE(end - begin, 40u);
  }
  EXPECT_EQ(begin, text.size());
  EXPECT_NE(text.find("! the publisher is gone"), std::string::npos);
  EXPECT_EQ(table_.Draw(kNow + 11s, 40).find("gone"), std::string::npos);
}

}  // namespace
}  // namespace wirepose::cli
