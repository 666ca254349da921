// Prints every object that wireposed finds, until a number of frames has come.
// Usage: wirepose_subscriber [FRAMES [MODEL_ID]]     FRAMES 0: without end; MODEL_ID: let wireposed search for it only
// The domain is ROS_DOMAIN_ID's, 0 without; CYCLONEDDS_URI holds for this program as for every other.
#include <dds/dds.h>
#include <dds_idl/wirepose.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

dds_entity_t Check(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    std::fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
    std::exit(1);
  }
  return entity;
}

dds_qos_t* Reliable(int depth) {
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth);
  return qos;
}

dds_entity_t CreateReader(dds_entity_t participant, const dds_topic_descriptor_t& type, const char* name) {
  const dds_entity_t topic = Check(dds_create_topic(participant, &type, name, nullptr, nullptr), name);
  dds_qos_t* const qos = Reliable(4);
  const dds_entity_t reader = Check(dds_create_reader(participant, topic, qos, nullptr), name);
  dds_delete_qos(qos);
  return reader;
}

void Print(const wirepose_Recognition& frame) {
  std::printf("frame %llu: %u objects\n", static_cast<unsigned long long>(frame.frame_sequence),
              frame.detections._length);
  for (uint32_t i = 0; i < frame.detections._length; ++i) {
    const wirepose_Detection& d = frame.detections._buffer[i];
    std::printf("  %s at %.3f %.3f %.3f m in %s, probability %.2f\n", d.name, d.pose.position_m[0],
                d.pose.position_m[1], d.pose.position_m[2], frame.frame_id, static_cast<double>(d.score));
  }
}

// Waits for wireposed, asks, waits for the answer.
bool SelectModel(dds_entity_t participant, uint32_t id) {
  const dds_entity_t answers = CreateReader(participant, wirepose_CommandStatus_desc, "wirepose/command_status");
  const dds_entity_t topic =
      Check(dds_create_topic(participant, &wirepose_Command_desc, "wirepose/command", nullptr, nullptr), "command");
  dds_qos_t* const qos = Reliable(16);
  const dds_entity_t writer = Check(dds_create_writer(participant, topic, qos, nullptr), "command");
  dds_delete_qos(qos);
  dds_publication_matched_status_t out{};
  dds_subscription_matched_status_t in{};
  for (int i = 0; i < 500 && (out.current_count == 0 || in.current_count == 0); ++i) {
    dds_sleepfor(DDS_MSECS(20));
    dds_get_publication_matched_status(writer, &out);
    dds_get_subscription_matched_status(answers, &in);
  }
  wirepose_Command command{};
  std::strcpy(command.sender, "example");
  command.request_id = 1;
  command.action = wirepose_SELECT_MODELS;
  command.model_ids = {1, 1, &id, false};
  dds_write(writer, &command);
  for (int i = 0; i < 500; ++i) {
    void* sample = nullptr;
    dds_sample_info_t info{};
    if (dds_take(answers, &sample, &info, 1, 1) > 0) {
      const auto* const answer = static_cast<const wirepose_CommandStatus*>(sample);
      const bool mine = info.valid_data && std::strcmp(answer->sender, command.sender) == 0;
      const bool accepted = mine && answer->accepted;
      if (mine) std::printf("select %u: %s%s\n", id, accepted ? "accepted" : "refused: ", answer->reason);
      dds_return_loan(answers, &sample, 1);
      if (mine) return accepted;
    }
    dds_sleepfor(DDS_MSECS(20));
  }
  std::fprintf(stderr, "no answer; is wireposed running in this domain?\n");
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  const char* const domain = std::getenv("ROS_DOMAIN_ID");
  const long wanted = argc > 1 ? std::atol(argv[1]) : 0;
  const dds_entity_t participant = Check(
      dds_create_participant(domain == nullptr ? 0 : static_cast<dds_domainid_t>(std::atoi(domain)), nullptr, nullptr),
      "participant");
  if (argc > 2 && !SelectModel(participant, static_cast<uint32_t>(std::atol(argv[2])))) return 1;

  const dds_entity_t reader = CreateReader(participant, wirepose_Recognition_desc, "wirepose/recognition");
  const dds_entity_t waitset = dds_create_waitset(participant);
  dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
  dds_waitset_attach(waitset, reader, 0);
  for (long frames = 0; wanted == 0 || frames < wanted;) {
    if (dds_waitset_wait(waitset, nullptr, 0, DDS_SECS(30)) == 0) {
      std::fprintf(stderr, "nothing for 30 s; is wireposed running in this domain?\n");
      return 1;
    }
    void* sample = nullptr;
    dds_sample_info_t info{};
    while (dds_take(reader, &sample, &info, 1, 1) > 0) {
      if (info.valid_data) {
        Print(*static_cast<const wirepose_Recognition*>(sample));
        ++frames;
      }
      dds_return_loan(reader, &sample, 1);  // always: the sample's memory is the reader's
      sample = nullptr;
    }
  }
  dds_delete(participant);
  return 0;
}
