#include "record/mcap_writer.h"

#include <zlib.h>

#include <algorithm>

namespace wirepose::record {
namespace {

constexpr char kMagic[] = "\x89MCAP0\r\n";
constexpr std::size_t kMagicBytes = 8;
// Large enough to cost little, small enough to lose little when the power fails.
constexpr std::size_t kChunkBytes = 1 << 20;

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

std::uint32_t Crc(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

}  // namespace

Result<McapWriter, std::string> McapWriter::Create(const std::filesystem::path& file) {
  McapWriter writer(file);
  writer.Put(std::string(kMagic, kMagicBytes));
  writer.Put(Record(kHeader, Bytes().AddText("ros2").AddText("wirepose").text()));
  if (auto status = writer.Status(); !status) return unexpected(status.error());
  return writer;
}

std::string McapWriter::Record(std::uint8_t opcode, const std::string& content) {
  return Bytes().Add(opcode).Add(std::uint64_t{content.size()}).AddRaw(content).text();
}

void McapWriter::Put(const std::string& bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  position_ += bytes.size();
}

Result<void, std::string> McapWriter::Status() const {
  if (out_) return {};
  return unexpected(path_.string() + ": cannot be written; check the folder, its permissions and the space left");
}

std::uint16_t McapWriter::AddChannel(const McapChannel& channel) {
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);  // 0 stands for no schema
  ChannelState state;
  state.schema_record = Record(kSchema, Bytes()
                                            .Add(id)
                                            .AddText(channel.schema_name)
                                            .AddText(channel.schema_encoding)
                                            .AddText(channel.schema)
                                            .text());
  state.channel_record =
      Record(kChannel, Bytes().Add(id).Add(id).AddText(channel.topic).AddText("cdr").Add(std::uint32_t{0}).text());
  Put(state.schema_record);
  Put(state.channel_record);
  channels_.push_back(std::move(state));
  return id;
}

Result<void, std::string> McapWriter::Write(const McapMessage& message) {
  ChannelState& channel = channels_[message.channel - 1U];
  const std::uint64_t time = message.log_time_ns;
  chunk_first_ns_ = chunk_.text().empty() ? time : std::min(chunk_first_ns_, time);
  chunk_last_ns_ = chunk_.text().empty() ? time : std::max(chunk_last_ns_, time);
  first_ns_ = messages_ == 0 ? time : std::min(first_ns_, time);
  last_ns_ = std::max(last_ns_, time);
  channel.index.emplace_back(time, chunk_.text().size());
  const std::string data(reinterpret_cast<const char*>(message.data.data()), message.data.size());
  chunk_.AddRaw(Record(kMessage, Bytes()
                                     .Add(message.channel)
                                     .Add(channel.sequence++)
                                     .Add(time)
                                     .Add(message.publish_time_ns)
                                     .AddRaw(data)
                                     .text()));
  ++channel.count;
  ++messages_;
  if (chunk_.text().size() >= kChunkBytes) EndChunk();
  return Status();
}

void McapWriter::EndChunk() {
  if (chunk_.text().empty()) return;
  const std::string& records = chunk_.text();
  ChunkEntry entry;
  entry.first_ns = chunk_first_ns_;
  entry.last_ns = chunk_last_ns_;
  entry.offset = position_;
  entry.bytes = records.size();
  Put(Record(kChunk, Bytes()
                         .Add(entry.first_ns)
                         .Add(entry.last_ns)
                         .Add(entry.bytes)
                         .Add(Crc(records))
                         .AddText("")  // not compressed
                         .Add(entry.bytes)
                         .AddRaw(records)
                         .text()));
  entry.length = position_ - entry.offset;
  const std::uint64_t indexes = position_;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    auto& index = channels_[i].index;
    if (index.empty()) continue;
    const auto id = static_cast<std::uint16_t>(i + 1);
    entry.index_offsets[id] = position_;
    Bytes content;
    content.Add(id).Add(static_cast<std::uint32_t>(16 * index.size()));
    for (const auto& [time, offset] : index) content.Add(time).Add(offset);
    Put(Record(kMessageIndex, content.text()));
    index.clear();
  }
  entry.index_length = position_ - indexes;
  chunks_.push_back(entry);
  chunk_.clear();
}

Result<void, std::string> McapWriter::Finish() {
  EndChunk();
  Put(Record(kDataEnd, Bytes().Add(std::uint32_t{0}).text()));  // no checksum of the whole: chunks have theirs
  WriteSummary();
  Put(std::string(kMagic, kMagicBytes));
  out_.flush();
  return Status();
}

void McapWriter::WriteSummary() {
  const std::uint64_t start = position_;
  Bytes summary, offsets;
  const auto group = [&](std::uint8_t opcode, const std::string& records) {
    if (records.empty()) return;
    offsets.AddRaw(Record(
        kSummaryOffset,
        Bytes().Add(opcode).Add(start + summary.text().size()).Add(std::uint64_t{records.size()}).text()));
    summary.AddRaw(records);
  };
  std::string schemas, channels, chunk_indexes;
  Bytes counts;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    schemas += channels_[i].schema_record;
    channels += channels_[i].channel_record;
    counts.Add(static_cast<std::uint16_t>(i + 1)).Add(channels_[i].count);
  }
  for (const ChunkEntry& chunk : chunks_) {
    Bytes entry;
    entry.Add(chunk.first_ns).Add(chunk.last_ns).Add(chunk.offset).Add(chunk.length);
    entry.Add(static_cast<std::uint32_t>(10 * chunk.index_offsets.size()));
    for (const auto& [id, offset] : chunk.index_offsets) entry.Add(id).Add(offset);
    entry.Add(chunk.index_length).AddText("").Add(chunk.bytes).Add(chunk.bytes);
    chunk_indexes += Record(kChunkIndex, entry.text());
  }
  const auto channel_count = static_cast<std::uint32_t>(channels_.size());
  Bytes statistics;
  statistics.Add(messages_).Add(static_cast<std::uint16_t>(channel_count)).Add(channel_count);
  statistics.Add(std::uint32_t{0}).Add(std::uint32_t{0}).Add(static_cast<std::uint32_t>(chunks_.size()));
  statistics.Add(first_ns_).Add(last_ns_).AddText(counts.text());
  group(kSchema, schemas);
  group(kChannel, channels);
  group(kStatistics, Record(kStatistics, statistics.text()));
  group(kChunkIndex, chunk_indexes);

  const std::uint64_t offsets_start = start + summary.text().size();
  summary.AddRaw(offsets.text());
  // The checksum covers the summary and the footer up to itself.
  Bytes footer;
  constexpr std::uint64_t kFooterBytes = 20;
  footer.Add(std::uint8_t{kFooter}).Add(kFooterBytes).Add(start).Add(offsets_start);
  summary.AddRaw(footer.text());
  Put(Bytes().AddRaw(summary.text()).Add(Crc(summary.text())).text());
}

}  // namespace wirepose::record
