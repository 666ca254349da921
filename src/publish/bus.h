// The DDS bus: participant, topics and their quality of service. For the publisher and for
// subscribers in tools.
#ifndef WIREPOSE_PUBLISH_BUS_H_
#define WIREPOSE_PUBLISH_BUS_H_

#include <dds/dds.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "base/result.h"
#include "publish/slot_type.h"

namespace wirepose {

// The topics, in the order of docs/dds.md.
enum class TopicId : std::uint8_t {
  kDetections,     // vision_msgs/Detection3DArray for ROS 2
  kRecognition,    // everything known about a frame
  kHealth,         // once a second and on change
  kMarkers,        // visualization_msgs/MarkerArray for ROS 2
  kDiagnostics,    // diagnostic_msgs/DiagnosticArray for ROS 2
  kCommand,        // to wireposed
  kCommandStatus,  // its answers
};
inline constexpr std::size_t kTopicCount = 7;

// What is fixed about a topic, and the defaults of what is not.
struct TopicSpec {
  const char* key;   // in the configuration and on command lines
  const char* name;  // default
  const dds_topic_descriptor_t* type;
  std::int32_t depth;      // default of TopicSettings::depth
  std::int32_t max_depth;  // what the memory is made for
  bool transient_local;    // who comes late gets the last samples
  const char* ros_hash;    // of the ROS 2 type (REP-2016), told to others as rmw_cyclonedds does; nullptr: not ROS
};
const TopicSpec& Spec(TopicId topic);

// What the configuration says about a topic.
struct TopicSettings {
  std::string name;
  bool reliable = true;
  std::int32_t depth = 1;                // keep-last: samples kept for a slow reader
  std::chrono::milliseconds deadline{0};  // promised time from sample to sample; 0: none
};
using TopicTable = std::array<TopicSettings, kTopicCount>;
TopicTable DefaultTopics();

// PEM and signed files of DDS Security, as scripts/make-security creates them.
struct SecurityFiles {
  std::string identity_ca, certificate, private_key;
  std::string permissions_ca, governance, permissions;
};

struct BusConfig {
  std::uint32_t domain = 0;  // 0..230, as ROS_DOMAIN_ID
  bool loopback = false;     // this machine only, without multicast
  TopicTable topics = DefaultTopics();
  std::optional<SecurityFiles> security;
};

inline constexpr std::uint32_t kMaxDomain = 230;  // above, the UDP ports of the DDS port formula run out

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

  // The handles live as long as the bus. With a slot type the writer works in its memory, and the type must outlive the
  // bus; without, in Cyclone's.
  [[nodiscard]] Result<dds_entity_t, std::string> CreateWriter(TopicId topic, SlotType* type = nullptr) const;
  [[nodiscard]] Result<dds_entity_t, std::string> CreateReader(TopicId topic,
                                                               const dds_listener_t* listener = nullptr) const;
  [[nodiscard]] dds_entity_t participant() const { return participant_.get(); }

 private:
  Bus(TopicTable topics, DdsEntity domain, DdsEntity participant)
      : topics_(std::move(topics)), domain_(std::move(domain)), participant_(std::move(participant)) {}

  TopicTable topics_;

  DdsEntity domain_;  // ends after the participant
  DdsEntity participant_;
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_BUS_H_
