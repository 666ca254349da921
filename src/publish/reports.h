// What the robot program tells the world: one report a frame, one on its health once a second.
// Plain data, no DDS.
#ifndef WIREPOSE_PUBLISH_REPORTS_H_
#define WIREPOSE_PUBLISH_REPORTS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/fixed_vector.h"
#include "base/time.h"
#include "pipeline/recognition.h"

namespace wirepose {

// Text in place, zero-terminated. Longer text is cut at the end of a whole UTF-8 character.
template <std::size_t kCapacity>
class FixedText {
 public:
  FixedText() = default;
  FixedText(std::string_view text) { *this = text; }  // NOLINT(google-explicit-constructor)
  FixedText& operator=(std::string_view text) {
    std::size_t size = text.size() < kCapacity ? text.size() : kCapacity - 1;
    // Bytes 10xxxxxx continue a character: do not cut before one.
    while (size < text.size() && size > 0 && (text[size] & '\xC0') == '\x80') --size;
    text.copy(chars_.data(), size);
    chars_[size] = '\0';
    return *this;
  }
  [[nodiscard]] const char* c_str() const { return chars_.data(); }
  operator std::string_view() const { return chars_.data(); }  // NOLINT(google-explicit-constructor)
  bool operator==(std::string_view other) const { return std::string_view(*this) == other; }
  bool operator==(const FixedText& other) const { return *this == std::string_view(other); }

 private:
  std::array<char, kCapacity> chars_{};
};

// One good frame and what was recognized in it.
struct FrameReport {
  std::uint64_t sequence = 0;
  CaptureTime capture_time{};
  std::uint64_t results_dropped = 0;  // filled in by Outbox::Offer
  RecognitionResult result;
};

// Where the program stands.
enum class HealthState : std::uint8_t {
  kStarting,    // before the first frame
  kRunning,     // the last frame was good
  kBadFrames,   // frames arrive, but the last one could not be used
  kNoFrames,    // the camera is there, no frame within the time-out
  kCameraLost,  // the camera is gone; the program tries again
  kStopped,     // ended in order; the last message
};
const char* Describe(HealthState state);

struct FrameCounts {
  std::uint64_t good = 0;
  std::uint64_t missing = 0;          // arrived without image
  std::uint64_t damaged = 0;          // arrived with pixels that cannot be trusted
  std::uint64_t not_synchronous = 0;  // left and right exposed at different times
  std::uint64_t late = 0;             // lost before they reached us: gaps in the sequence
  std::uint64_t failed = 0;           // good frames that the recognizer refused
};

struct StageTime {
  FixedText<32> stage;
  std::uint64_t p50_ns = 0, p99_ns = 0, max_ns = 0;
};

// Every stage and the whole frame.
using StageTimes = FixedVector<StageTime, kStageCount + 1>;

struct HealthReport {
  HealthState state = HealthState::kStarting;
  std::uint64_t uptime_ns = 0;
  FrameCounts frames;
  FixedText<32> camera;         // backend
  FixedText<64> camera_status;  // "ok", or what is wrong now
  FixedText<256> last_error;    // empty: none since the start
  StageTimes stage_times;
  RecognitionStatistics lists;  // highest use and sum of drops since the start
  std::uint32_t queue_high_water = 0, queue_capacity = 0;
  std::uint64_t results_dropped = 0, write_errors = 0;
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_REPORTS_H_
