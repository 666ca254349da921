#include "publish/bus.h"

#include <cstdlib>
#include <memory>

#include "dds_idl/diagnostic_msgs.h"
#include "dds_idl/sensor_msgs.h"
#include "dds_idl/vision_msgs.h"
#include "dds_idl/visualization_msgs.h"
#include "dds_idl/wirepose.h"
#include "publish/security_settings.h"

namespace wirepose {
namespace {

// Small buffers and stacks: one participant needs about 0.2 MB instead of Cyclone's 2.5. It calls out twice a second,
// not once in 30: peers whose lease ran out while the network was cut find each other again at once.
constexpr char kSmall[] =
    R"(<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any">
<General><MaxMessageSize>8 KiB</MaxMessageSize></General>
<Sizing><ReceiveBufferSize>72 KiB</ReceiveBufferSize><ReceiveBufferChunkSize>16 KiB</ReceiveBufferChunkSize></Sizing>
<Internal><MultipleReceiveThreads>false</MultipleReceiveThreads></Internal>
<Discovery><SPDPInterval>500 ms</SPDPInterval></Discovery>
<Threads><Thread Name="recv"><StackSize>128 KiB</StackSize></Thread></Threads>
</Domain></CycloneDDS>)";

// Without multicast peers are found by asking the first ports of this machine, one a participant.
constexpr char kLoopback[] =
    R"(<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any">
<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces><AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>8</MaxAutoParticipantIndex>
<Peers><Peer Address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>)";

std::string Settings(const BusConfig& config) {
  std::string settings = kSmall;
  if (config.loopback) settings.append(",").append(kLoopback);
  if (config.security) settings.append(",").append(SecuritySettings(*config.security));
  if (const char* const uri = std::getenv("CYCLONEDDS_URI"); uri != nullptr && *uri != '\0') {
    settings.append(",").append(uri);
  }
  return settings;
}

std::string Failure(const std::string& what, dds_return_t code, const char* remedy) {
  return what + ": " + dds_strretcode(-code) + "; " + remedy;
}

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

// A burst of commands waits in the reader until the program has answered; what does not fit waits at the sender.
constexpr std::int32_t kMaxWaitingCommands = 32;

Qos MakeQos(TopicId id, const TopicSettings& topic, bool writer) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(), topic.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_MSECS(100));
  if (id == TopicId::kCommand && !writer) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_resource_limits(qos.get(), kMaxWaitingCommands, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  } else {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, topic.depth);
  }
  const bool transient = Spec(id).transient_local;
  dds_qset_durability(qos.get(), transient ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, topic.depth, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  if (topic.deadline.count() > 0) dds_qset_deadline(qos.get(), DDS_MSECS(topic.deadline.count()));
  dds_qset_writer_data_lifecycle(qos.get(), false);  // as ROS 2's writers
  if (const char* const hash = Spec(id).ros_hash; hash != nullptr) {
    const std::string user_data = std::string("typehash=").append(hash).append(";");
    dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  }
  return qos;
}

Result<dds_entity_t, std::string> Created(dds_entity_t endpoint, const char* kind, const TopicSettings& topic) {
  if (endpoint >= 0) return endpoint;
  return unexpected(Failure(std::string("DDS ") + kind + " for topic " + topic.name, endpoint,
                            "check that no other program uses the topic with another type, and with security that the "
                            "permissions allow it"));
}

}  // namespace

const TopicSpec& Spec(TopicId topic) {
  static const TopicSpec specs[kTopicCount] = {
      {"detections", "rt/wirepose/detections", &vision_msgs_msg_dds__Detection3DArray__desc, 4, 4, false,
       "RIHS01_793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018"},
      {"recognition", "wirepose/recognition", &wirepose_Recognition_desc, 4, 4, false, nullptr},
      {"health", "wirepose/health", &wirepose_Health_desc, 1, 1, true, nullptr},
      {"markers", "rt/wirepose/markers", &visualization_msgs_msg_dds__MarkerArray__desc, 1, 1, false,
       "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"},
      {"diagnostics", "rt/diagnostics", &diagnostic_msgs_msg_dds__DiagnosticArray__desc, 1, 1, false,
       "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
      {"image", "rt/wirepose/left/image_raw", &sensor_msgs_msg_dds__Image__desc, 1, 1, false,
       "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
      {"command", "wirepose/command", &wirepose_Command_desc, 16, 16, false, nullptr},
      {"command_status", "wirepose/command_status", &wirepose_CommandStatus_desc, 16, 16, false, nullptr},
  };
  return specs[static_cast<std::size_t>(topic)];
}

TopicTable DefaultTopics() {
  TopicTable topics;
  for (std::size_t i = 0; i < kTopicCount; ++i) {
    const TopicSpec& spec = Spec(static_cast<TopicId>(i));
    topics[i].name = spec.name;
    topics[i].depth = spec.depth;
  }
  return topics;
}

Result<Bus, std::string> Bus::Open(const BusConfig& config) {
  const std::string where = "DDS domain " + std::to_string(config.domain);
  const dds_entity_t domain = dds_create_domain(config.domain, Settings(config).c_str());
  // Somebody else in this process has opened the domain: its settings hold.
  const bool shared = domain == DDS_RETCODE_PRECONDITION_NOT_MET;
  if (domain < 0 && !shared) {
    return unexpected(
        Failure(where, domain, "check CYCLONEDDS_URI, that the domain is 0 to 230, and the files of dds.security"));
  }
  DdsEntity owned_domain(shared ? 0 : domain);
  const dds_entity_t participant = dds_create_participant(config.domain, nullptr, nullptr);
  if (participant < 0) {
    return unexpected(Failure(where + ": no participant", participant,
                              config.loopback ? "with loopback, at most 9 programs share a domain; end one"
                                              : "check that a network interface is up, or set dds.loopback"));
  }
  return Bus(config.topics, std::move(owned_domain), DdsEntity(participant));
}

Result<dds_entity_t, std::string> Bus::CreateWriter(TopicId id, SlotType* type) const {
  const TopicSettings& settings = topics_[static_cast<std::size_t>(id)];
  const dds_entity_t topic =
      type != nullptr ? type->CreateTopic(participant(), settings.name.c_str())
                      : dds_create_topic(participant(), Spec(id).type, settings.name.c_str(), nullptr, nullptr);
  const Qos qos = MakeQos(id, settings, true);
  return Created(topic < 0 ? topic : dds_create_writer(participant(), topic, qos.get(), nullptr), "writer", settings);
}

Result<dds_entity_t, std::string> Bus::CreateReader(TopicId id, const dds_listener_t* listener) const {
  const TopicSettings& settings = topics_[static_cast<std::size_t>(id)];
  const dds_entity_t topic = dds_create_topic(participant(), Spec(id).type, settings.name.c_str(), nullptr, nullptr);
  const Qos qos = MakeQos(id, settings, false);
  return Created(topic < 0 ? topic : dds_create_reader(participant(), topic, qos.get(), listener), "reader", settings);
}

}  // namespace wirepose
