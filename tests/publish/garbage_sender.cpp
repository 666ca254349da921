// Sends bytes that are no command under the name of the command type: garbage_sender DOMAIN COUNT.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>

#include "garbage.h"
#include "publish/bus.h"

int main(int argc, char** argv) {
  using namespace wirepose;
  if (argc != 3) return 2;
  BusConfig config;
  config.domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  config.loopback = true;
  const Result<Bus, std::string> bus = Bus::Open(config);
  if (!bus) return 1;
  dds_topic_descriptor_t type = wirepose_test_Garbage_desc;
  type.m_typename = Spec(TopicId::kCommand).type->m_typename;
  const dds_entity_t topic = dds_create_topic(bus->participant(), &type, Spec(TopicId::kCommand).name, nullptr, nullptr);
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  const dds_entity_t writer = dds_create_writer(bus->participant(), topic, qos, nullptr);
  dds_delete_qos(qos);
  dds_publication_matched_status_t matched{};
  for (int i = 0; i < 1000 && matched.current_count == 0; ++i) {
    dds_sleepfor(DDS_MSECS(10));
    dds_get_publication_matched_status(writer, &matched);
  }
  if (matched.current_count == 0) return 1;
  std::mt19937 random(3);
  wirepose_test_Garbage garbage{};
  for (int i = 0; i < std::atoi(argv[2]); ++i) {
    for (unsigned char& byte : garbage.bytes) byte = static_cast<unsigned char>(random());
    // Half of them begin as commands do, with a short sender, and go wrong later.
    if (i % 2 == 0) std::memcpy(garbage.bytes, "\x04\0\0\0abc\0", 8);
    if (dds_write(writer, &garbage) < 0) return 1;
  }
  if (dds_wait_for_acks(writer, DDS_SECS(10)) < 0) return 1;
  return 0;
}
