#include "record_command.h"

#include <dds/ddsi/ddsi_serdata.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <vector>

#include "bus_options.h"
#include "record/mcap_writer.h"
#include "record/schemas.h"

namespace wirepose::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct RecordOptions {
  BusOptions bus;
  std::string out;
  std::vector<std::string> topics;  // keys; empty: all
  double duration_s = 0;
  std::uint64_t frames = 0;
};

volatile std::sig_atomic_t g_stop = 0;

std::uint64_t Now_ns() {
  return static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1));
}

// One topic: its reader and its channel in the file.
struct Track {
  TopicId topic;
  dds_entity_t reader;
  std::uint16_t channel;
  std::uint64_t messages = 0;
};

void Write(ddsi_serdata* data, const dds_sample_info_t& info, const Track& track, record::McapWriter& writer) {
  ddsrt_iovec_t bytes{};
  ddsi_serdata* const reference = ddsi_serdata_to_ser_ref(data, 0, ddsi_serdata_size(data), &bytes);
  const auto written = writer.Write({track.channel, Now_ns(), static_cast<std::uint64_t>(info.source_timestamp),
                                     {static_cast<const unsigned char*>(bytes.iov_base), bytes.iov_len}});
  ddsi_serdata_to_ser_unref(reference, &bytes);
  if (!written) throw WorkFailed(written.error());
}

// Returns whether there was something.
bool WriteNew(Track& track, record::McapWriter& writer) {
  bool any = false;
  ddsi_serdata* data = nullptr;
  dds_sample_info_t info{};
  while (dds_takecdr(track.reader, &data, 1, &info, DDS_ANY_STATE) > 0) {
    if (info.valid_data) {
      Write(data, info, track, writer);
      ++track.messages;
      any = true;
    }
    ddsi_serdata_unref(data);
  }
  return any;
}

std::vector<Track> Subscribe(const RecordOptions& options, const Bus& bus, record::McapWriter& writer) {
  const BusConfig config = BusConfigOf(options.bus);
  std::vector<Track> tracks;
  for (std::size_t i = 0; i < kTopicCount; ++i) {
    const auto topic = static_cast<TopicId>(i);
    const auto& wanted = options.topics;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), Spec(topic).key) == wanted.end()) continue;
    tracks.push_back({topic, OpenReader(bus, topic), writer.AddChannel(record::ChannelOf(topic, config.topics[i].name))});
  }
  return tracks;
}

void Record(const RecordOptions& options) {
  const Bus bus = OpenBus(options.bus);
  auto writer = record::McapWriter::Create(options.out);
  if (!writer) throw WorkFailed(writer.error());
  std::vector<Track> tracks = Subscribe(options, bus, *writer);
  std::signal(SIGINT, [](int) { g_stop = 1; });
  std::signal(SIGTERM, [](int) { g_stop = 1; });
  const Clock::time_point start = Clock::now();
  const auto frames = [&] {
    std::uint64_t most = 0;
    for (const Track& track : tracks) {
      if (track.topic == TopicId::kDetections || track.topic == TopicId::kRecognition) {
        most = std::max(most, track.messages);
      }
    }
    return most;
  };
  while (g_stop == 0) {
    bool any = false;
    for (Track& track : tracks) any |= WriteNew(track, *writer);
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - start).count();
    if (options.duration_s > 0 && elapsed_s >= options.duration_s) break;
    if (options.frames > 0 && frames() >= options.frames) break;
    if (!any) dds_sleepfor(DDS_MSECS(2));
  }
  if (const auto finished = writer->Finish(); !finished) throw WorkFailed(finished.error());
  if (writer->messages() == 0) {
    throw WorkFailed(fmt::format("{}: nothing arrived on {}; is wireposed running with the same domain, loopback "
                                 "setting and topic names?",
                                 options.out, Where(options.bus)));
  }
  std::string summary;
  for (const Track& track : tracks) summary += fmt::format(" {} {}", Spec(track.topic).key, track.messages);
  std::printf("%s: %llu messages:%s\n", options.out.c_str(), static_cast<unsigned long long>(writer->messages()),
              summary.c_str());
}

}  // namespace

void AddRecordCommand(CLI::App& app) {
  const auto options = std::make_shared<RecordOptions>();
  CLI::App* const command = app.add_subcommand("record", "write what is on the bus into an MCAP file, until Ctrl-C");
  command->add_option("--out", options->out, "file to write, .mcap; overwritten")->required();
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < kTopicCount; ++i) keys.emplace_back(Spec(static_cast<TopicId>(i)).key);
  command->add_option("--topic", options->topics, "only this one; may be repeated; default: all")
      ->check(CLI::IsMember(keys));
  command->add_option("--duration", options->duration_s, "end after that many seconds; 0: never")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--frames", options->frames, "end after that many frames; 0: never");
  AddBusOptions(*command, options->bus);
  command->callback([options] { Record(*options); });
}

}  // namespace wirepose::cli
