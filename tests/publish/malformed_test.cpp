// What does not deserve an answer: damaged packets, and messages that are no commands.
#include <arpa/inet.h>
#include <sys/socket.h>

#include "stress_test_base.h"

namespace wirepose {
namespace {

using std::chrono::milliseconds;
using test::Process;

class MalformedTest : public test::StressTest {
 protected:
  // Ports of the DDS port formula for participants 0 to 8 of the domain, discovery and data.
  void SendToAllPorts(const std::vector<unsigned char>& bytes) {
    for (int participant = 0; participant < 9; ++participant) {
      for (const int offset : {10, 11}) {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        to.sin_port =
            htons(static_cast<std::uint16_t>(7400 + 250 * static_cast<int>(domain_.id()) + 2 * participant + offset));
        (void)sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
      }
    }
  }
  unsigned char Byte() { return static_cast<unsigned char>(random_()); }

  // A header that is right, and submessages that are not: kinds that exist, lengths that lie.
  std::vector<unsigned char> Packet() {
    constexpr unsigned char kKinds[] = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d,
                                        0x0e, 0x12, 0x13, 0x15, 0x16, 0x30, 0x33};
    std::vector<unsigned char> bytes = {'R', 'T', 'P', 'S', 2, 1, 1, 16};
    for (int i = 0; i < 12; ++i) bytes.push_back(Byte());
    for (unsigned submessages = 1 + random_() % 4; submessages > 0; --submessages) {
      const std::size_t size = random_() % 200;
      const std::size_t told = random_() % 4 == 0 ? random_() % 0x10000 : size;
      bytes.insert(bytes.end(), {kKinds[random_() % std::size(kKinds)], static_cast<unsigned char>(random_() % 16),
                                 static_cast<unsigned char>(told), static_cast<unsigned char>(told >> 8)});
      for (std::size_t i = 0; i < size; ++i) bytes.push_back(random_() % 3 == 0 ? Byte() : 0);
    }
    if (random_() % 10 == 0) bytes.resize(random_() % bytes.size());
    return bytes;
  }

  int socket_ = socket(AF_INET, SOCK_DGRAM, 0);
};

TEST_F(MalformedTest, ThousandDamagedPackets) {
  const auto subscriber = Subscribe({"recognition"});
  ASSERT_TRUE(WaitForData(*subscriber, report_));
  Publish(50, report_, milliseconds(5));
  const std::size_t before = UsedKib();
  for (int i = 0; i < 1000; ++i) {
    SendToAllPorts(Packet());
    if (i % 10 == 0) Publish(1, report_, milliseconds(2));
  }
  Publish(100, report_, milliseconds(5));
  std::printf("1000 packets: pool %zu KiB before, %zu after\n", before, UsedKib());
  EXPECT_LT(UsedKib(), before + 32);
  EXPECT_EQ(Finish(*subscriber).size(), 1u) << "the subscriber, which got them too, has died";
  ExpectHealthy();
}

// Bytes that are no command, under the name of the command type.
TEST_F(MalformedTest, ThousandMessagesThatAreNoCommands) {
  const std::size_t before = UsedKib();
  Process sender(folder_, "sender", {WIREPOSE_TEST_GARBAGE_SENDER, std::to_string(domain_.id()), "1000"});
  EXPECT_EQ(sender.Wait(), 0) << sender.Err() << "; all were sent and acknowledged";
  Publish(50, report_, milliseconds(5));
  std::printf("1000 messages: pool %zu KiB before, %zu after, %zu at most\n", before, UsedKib(),
              DdsPoolUse().high_water >> 10);
  Command received;
  EXPECT_FALSE(publisher_->TakeCommand(received)) << "garbage was read as a command";
  EXPECT_LT(UsedKib(), before + 32);
  ExpectHealthy();

  // A real one still gets through.
  const Result<Bus, std::string> second = Bus::Open(config_.bus);
  const Result<dds_entity_t, std::string> real = second->CreateWriter(TopicId::kCommand);
  ASSERT_TRUE(real) << real.error();
  dds_sleepfor(DDS_MSECS(300));
  const auto command = std::make_unique<CommandMessage>();
  command->value.request_id = 42;
  command->value.action = wirepose_PAUSE;
  ASSERT_EQ(dds_write(*real, &command->value), 0);
  ASSERT_TRUE(WaitUntil([&] { return publisher_->TakeCommand(received); }));
  EXPECT_EQ(received.request_id, 42u);
  EXPECT_EQ(received.action, CommandAction::kPause);
  publisher_->Answer({received, true, {}, false, {}, {}});
}

}  // namespace
}  // namespace wirepose
