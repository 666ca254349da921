#include "publish/bus.h"

#include <cstdlib>
#include <memory>
#include <type_traits>

#include "dds_idl/vision_msgs.h"
#include "dds_idl/wirepose.h"

namespace wirepose {
namespace {

// Small buffers and stacks: one participant needs about 0.2 MB instead of Cyclone's 2.5.
constexpr char kSmall[] =
    R"(<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any">
<General><MaxMessageSize>8 KiB</MaxMessageSize></General>
<Sizing><ReceiveBufferSize>72 KiB</ReceiveBufferSize><ReceiveBufferChunkSize>16 KiB</ReceiveBufferChunkSize></Sizing>
<Internal><MultipleReceiveThreads>false</MultipleReceiveThreads></Internal>
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
  if (config.loopback) settings += std::string(",") + kLoopback;
  if (const char* const uri = std::getenv("CYCLONEDDS_URI"); uri != nullptr && *uri != '\0') {
    settings += std::string(",") + uri;
  }
  return settings;
}

std::string Failure(const std::string& what, dds_return_t code, const char* remedy) {
  return what + ": " + dds_strretcode(-code) + "; " + remedy;
}

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

Qos MakeQos(const TopicSpec& topic) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, topic.depth);
  dds_qset_durability(qos.get(), topic.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, topic.depth, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  dds_qset_writer_data_lifecycle(qos.get(), false);  // as ROS 2's writers
  return qos;
}

template <typename Create>
Result<dds_entity_t, std::string> CreateEndpoint(dds_entity_t participant, const TopicSpec& spec, const char* kind,
                                                 Create create) {
  const Qos qos = MakeQos(spec);
  const dds_entity_t topic = dds_create_topic(participant, spec.type, spec.name, nullptr, nullptr);
  const dds_entity_t endpoint = topic < 0 ? topic : create(participant, topic, qos.get(), nullptr);
  if (endpoint < 0) {
    return unexpected(Failure(std::string("DDS ") + kind + " for topic " + spec.name, endpoint,
                              "check that no other program uses the topic with another type"));
  }
  return endpoint;
}

}  // namespace

const TopicSpec kDetectionsTopic = {"rt/wirepose/detections", &vision_msgs_msg_dds__Detection3DArray__desc, 4, false};
const TopicSpec kRecognitionTopic = {"wirepose/recognition", &wirepose_Recognition_desc, 4, false};
const TopicSpec kHealthTopic = {"wirepose/health", &wirepose_Health_desc, 1, true};

Result<Bus, std::string> Bus::Open(const BusConfig& config) {
  const std::string where = "DDS domain " + std::to_string(config.domain);
  const dds_entity_t domain = dds_create_domain(config.domain, Settings(config).c_str());
  // Somebody else in this process has opened the domain: its settings hold.
  const bool shared = domain == DDS_RETCODE_PRECONDITION_NOT_MET;
  if (domain < 0 && !shared) {
    return unexpected(Failure(where, domain, "check CYCLONEDDS_URI and that the domain is 0 to 230"));
  }
  DdsEntity owned_domain(shared ? 0 : domain);
  const dds_entity_t participant = dds_create_participant(config.domain, nullptr, nullptr);
  if (participant < 0) {
    return unexpected(Failure(where + ": no participant", participant,
                              config.loopback ? "with loopback, at most 9 programs share a domain; end one"
                                              : "check that a network interface is up, or set dds.loopback"));
  }
  return Bus(std::move(owned_domain), DdsEntity(participant));
}

Result<dds_entity_t, std::string> Bus::CreateWriter(const TopicSpec& topic) const {
  return CreateEndpoint(participant(), topic, "writer", dds_create_writer);
}

Result<dds_entity_t, std::string> Bus::CreateReader(const TopicSpec& topic) const {
  return CreateEndpoint(participant(), topic, "reader", dds_create_reader);
}

}  // namespace wirepose
