// The DDS bus: participant, topics and their quality of service. For the publisher and for
// subscribers in tools.
#ifndef WIREPOSE_PUBLISH_BUS_H_
#define WIREPOSE_PUBLISH_BUS_H_

#include <dds/dds.h>

#include <cstdint>
#include <string>
#include <utility>

#include "base/result.h"

namespace wirepose {

struct BusConfig {
  std::uint32_t domain = 0;  // 0..230, as ROS_DOMAIN_ID
  bool loopback = false;     // this machine only, without multicast
};

inline constexpr std::uint32_t kMaxDomain = 230;  // above, the UDP ports of the DDS port formula run out

// A topic of DESIGN's table; reliable and keep-last, all of them.
struct TopicSpec {
  const char* name;
  const dds_topic_descriptor_t* type;
  std::int32_t depth;    // samples kept for a slow reader
  bool transient_local;  // who comes late gets the last samples
};
extern const TopicSpec kDetectionsTopic;   // rt/wirepose/detections, vision_msgs/Detection3DArray for ROS 2
extern const TopicSpec kRecognitionTopic;  // wirepose/recognition
extern const TopicSpec kHealthTopic;       // wirepose/health

// Owns a DDS entity and with it all that was created from it.
class DdsEntity {
 public:
  DdsEntity() = default;
  explicit DdsEntity(dds_entity_t handle) : handle_(handle) {}
  DdsEntity(DdsEntity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  DdsEntity& operator=(DdsEntity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~DdsEntity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  [[nodiscard]] dds_entity_t get() const { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

// One participant. Errors are one line: what failed, where, and what to do.
//
// The first Bus of a process in a domain decides the domain's settings and, at its end, ends the
// domain for all. What CYCLONEDDS_URI says is applied after our settings, so the integrator has the
// last word.
class Bus {
 public:
  static Result<Bus, std::string> Open(const BusConfig& config);

  // The handles live as long as the bus.
  [[nodiscard]] Result<dds_entity_t, std::string> CreateWriter(const TopicSpec& topic) const;
  [[nodiscard]] Result<dds_entity_t, std::string> CreateReader(const TopicSpec& topic) const;
  [[nodiscard]] dds_entity_t participant() const { return participant_.get(); }

 private:
  Bus(DdsEntity domain, DdsEntity participant) : domain_(std::move(domain)), participant_(std::move(participant)) {}

  DdsEntity domain_;  // ends after the participant
  DdsEntity participant_;
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_BUS_H_
