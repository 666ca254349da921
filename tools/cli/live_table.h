// What `wirepose watch` shows on a terminal: the objects in view, how the robot program is, how well the bus keeps up.
#ifndef WIREPOSE_TOOLS_CLI_LIVE_TABLE_H_
#define WIREPOSE_TOOLS_CLI_LIVE_TABLE_H_

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dds_idl/wirepose.h"

namespace wirepose::cli {

// Gathers messages and draws them as text. Reads no clock: the caller says what time it is. Not thread safe.
class LiveTable {
 public:
  using Time = std::chrono::nanoseconds;  // since the Unix epoch

  void Add(const wirepose_Recognition& message, Time now);
  void Add(const wirepose_Health& message, Time now);
  // A line that stays for a while: events of the bus.
  void Note(const std::string& text, Time now);

  // All lines, each ended; no longer than `width` columns. Objects that were last seen longer than kForget ago are left
  // out.
  [[nodiscard]] std::string Draw(Time now, std::size_t width) const;

  // Frames a second over the last second; median latency from capture to here over the same time, if known.
  [[nodiscard]] double Rate(Time now) const;
  [[nodiscard]] std::optional<Time> Latency() const;

 private:
  static constexpr std::chrono::seconds kWindow{1};
  static constexpr std::chrono::seconds kForget{2};
  static constexpr std::chrono::seconds kNoteStays{10};

  struct Row {
    wirepose_Detection detection{};  // without modes: their memory is the message's
    std::uint32_t modes = 0;
    Time seen{};
  };
  struct Arrival {
    Time when, latency;
  };

  // A track, or the nth untracked object of a model in a frame.
  using Key = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Key, Row> rows_;
  std::deque<Arrival> arrivals_;
  std::optional<std::string> health_;
  Time health_seen_{};
  std::uint64_t frame_ = 0, lost_ = 0;
  bool any_frame_ = false;
  std::deque<std::pair<Time, std::string>> notes_;
};

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_LIVE_TABLE_H_
