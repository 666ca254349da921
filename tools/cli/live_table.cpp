#include "live_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "message_text.h"

namespace wirepose::cli {
namespace {

// A system clock that differs by more is another machine's, and the latency would mean nothing.
constexpr std::chrono::seconds kPlausibleLatency{5};

double Seconds(LiveTable::Time time) { return std::chrono::duration<double>(time).count(); }

// Cuts each line at `width` columns; the text is ASCII but for names, whose bytes count.
std::string Cut(const std::string& line, std::size_t width) { return line.substr(0, width) + "\n"; }

std::string RowText(const wirepose_Detection& d, std::uint32_t modes, double age_s) {
  const auto& p = d.pose.position_m;
  const auto& q = d.pose.orientation_xyzw;
  const double angle_deg = 2 * std::acos(std::clamp(q[3], -1.0, 1.0)) * 180 / 3.14159265358979323846;
  const std::string track = d.track_id == 0 ? "-" : std::to_string(d.track_id);
  return fmt::format(
      "{:<20.20} {:>4} {:>6} {:>8.3f} {:>8.3f} {:>8.3f} {:>7.1f} {:>7.1f} {:>7.2f} {:>6.3f} {:>5.2f} {:>5} {:>5.1f}",
      d.name, d.model_id, track, p[0], p[1], p[2], angle_deg, 1e3 * PositionSigma(d.covariance),
      RotationSigma_deg(d.covariance), d.score, d.visible_fraction, modes, age_s);
}

}  // namespace

void LiveTable::Add(const wirepose_Recognition& message, Time now) {
  if (any_frame_ && message.frame_sequence > frame_ + 1) lost_ += message.frame_sequence - frame_ - 1;
  any_frame_ = true;
  frame_ = message.frame_sequence;
  arrivals_.push_back({now, now - Time(message.stamp_ns)});
  while (now - arrivals_.front().when > kWindow) arrivals_.pop_front();

  std::map<std::uint32_t, std::uint32_t> untracked;  // model id -> how many so far
  for (const wirepose_Detection& detection : std::span(message.detections._buffer, message.detections._length)) {
    const Key key = detection.track_id != 0 ? Key(0, detection.track_id)
                                            : Key(1 + detection.model_id, untracked[detection.model_id]++);
    Row& row = rows_[key];
    row.detection = detection;
    row.detection.modes = {};
    row.modes = detection.modes._length;
    row.seen = now;
  }
  std::erase_if(rows_, [now](const auto& entry) { return now - entry.second.seen > kForget; });
}

void LiveTable::Add(const wirepose_Health& message, Time now) {
  health_ = fmt::format(
      "{}: camera {}: {}; rows {} ({:.2f} px); {} good frames, {} bad, {} dropped; {} subscribers; "
      "pool {} of {} KiB",
      StateName(message.state), message.camera, message.camera_status, StateName(message.rows.state),
      std::max(message.rows.steady_px, message.rows.varying_px), message.frames.good,
      message.frames.missing + message.frames.damaged + message.frames.not_synchronous + message.frames.late +
          message.frames.failed,
      message.results_dropped, message.events.subscribers, message.pool.used_bytes >> 10,
      message.pool.capacity_bytes >> 10);
  health_seen_ = now;
}

void LiveTable::Note(const std::string& text, Time now) { notes_.emplace_back(now, text); }

double LiveTable::Rate(Time now) const {
  const auto recent = std::count_if(arrivals_.begin(), arrivals_.end(),
                                    [now](const Arrival& arrival) { return now - arrival.when <= kWindow; });
  return static_cast<double>(recent) / Seconds(kWindow);
}

std::optional<LiveTable::Time> LiveTable::Latency() const {
  if (arrivals_.empty()) return std::nullopt;
  std::vector<Time> latencies;
  for (const Arrival& arrival : arrivals_) latencies.push_back(arrival.latency);
  const auto middle = latencies.begin() + static_cast<std::ptrdiff_t>(latencies.size() / 2);
  std::nth_element(latencies.begin(), middle, latencies.end());
  if (*middle < Time(0) || *middle > kPlausibleLatency) return std::nullopt;
  return *middle;
}

std::string LiveTable::Draw(Time now, std::size_t width) const {
  std::string text;
  const std::optional<Time> latency = Latency();
  text += Cut(fmt::format("frame {}, {:.0f} per second, {} lost on the way, latency {}", frame_, Rate(now), lost_,
                          latency ? fmt::format("{:.1f} ms", 1e3 * Seconds(*latency)) : "unknown"),
              width);
  text += Cut(!health_ ? "health: nothing heard yet"
                       : fmt::format("health {}{}", *health_,
                                     now - health_seen_ > std::chrono::seconds(3)
                                         ? fmt::format(" (silent for {:.0f} s)", Seconds(now - health_seen_))
                                         : ""),
              width);
  text +=
      Cut(fmt::format("{:<20} {:>4} {:>6} {:>8} {:>8} {:>8} {:>7} {:>7} {:>7} {:>6} {:>5} {:>5} {:>5}", "object", "id",
                      "track", "x m", "y m", "z m", "turn", "+-mm", "+-deg", "score", "seen", "modes", "age s"),
          width);
  for (const auto& [key, row] : rows_) {
    if (now - row.seen > kForget) continue;
    text += Cut(RowText(row.detection, row.modes, Seconds(now - row.seen)), width);
  }
  if (rows_.empty()) text += "no objects\n";
  for (const auto& [when, note] : notes_) {
    if (now - when <= kNoteStays) text += Cut("! " + note, width);
  }
  return text;
}

}  // namespace wirepose::cli
