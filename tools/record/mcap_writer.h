// Writes MCAP files (https://mcap.dev/spec): chunks with indexes and a summary, so that viewers can seek.
#ifndef WIREPOSE_TOOLS_RECORD_MCAP_WRITER_H_
#define WIREPOSE_TOOLS_RECORD_MCAP_WRITER_H_

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace wirepose::record {

struct McapChannel {
  std::string topic;
  std::string schema_name;      // "vision_msgs/msg/Detection3DArray"
  std::string schema_encoding;  // "ros2msg" or "omgidl"
  std::string schema;           // the definition itself
};

struct McapMessage {
  std::uint16_t channel = 0;
  std::uint64_t log_time_ns = 0;      // when it was received
  std::uint64_t publish_time_ns = 0;  // when it was sent
  std::span<const unsigned char> data;  // CDR, encapsulation header first
};

// A file that was not finished holds its whole chunks, but no index: readers that stream still understand it. Not thread
// safe. Memory: one chunk, and 16 bytes a message of it.
class McapWriter {
 public:
  // Overwrites the file. Errors name it.
  static Result<McapWriter, std::string> Create(const std::filesystem::path& file);

  // All channels before the first message.
  std::uint16_t AddChannel(const McapChannel& channel);
  Result<void, std::string> Write(const McapMessage& message);
  // Writes the rest and the summary. Nothing may be written afterwards.
  Result<void, std::string> Finish();

  [[nodiscard]] std::uint64_t messages() const { return messages_; }

 private:
  // Grows by fields as the format lays them out: little-endian, texts with their length.
  class Bytes {
   public:
    template <typename T>
    Bytes& Add(T value) {
      for (std::size_t i = 0; i < sizeof value; ++i) {
        bytes_.push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i)));
      }
      return *this;
    }
    Bytes& AddText(const std::string& text) {
      Add(static_cast<std::uint32_t>(text.size()));
      bytes_ += text;
      return *this;
    }
    Bytes& AddRaw(const std::string& raw) {
      bytes_ += raw;
      return *this;
    }
    [[nodiscard]] const std::string& text() const { return bytes_; }
    void clear() { bytes_.clear(); }

   private:
    std::string bytes_;
  };
  struct ChannelState {
    std::string schema_record, channel_record;
    std::uint32_t sequence = 0;
    std::uint64_t count = 0;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> index;  // log time, offset in the chunk under way
  };
  struct ChunkEntry {
    std::uint64_t first_ns = 0, last_ns = 0, offset = 0, length = 0, index_length = 0, bytes = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
  };

  explicit McapWriter(const std::filesystem::path& file) : path_(file), out_(file, std::ios::binary) {}

  static std::string Record(std::uint8_t opcode, const std::string& content);
  void Put(const std::string& bytes);
  void EndChunk();
  void WriteSummary();
  [[nodiscard]] Result<void, std::string> Status() const;

  std::filesystem::path path_;
  std::ofstream out_;
  std::uint64_t position_ = 0;
  std::vector<ChannelState> channels_;
  Bytes chunk_;
  std::uint64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::vector<ChunkEntry> chunks_;
  std::uint64_t messages_ = 0, first_ns_ = 0, last_ns_ = 0;
};

}  // namespace wirepose::record

#endif  // WIREPOSE_TOOLS_RECORD_MCAP_WRITER_H_
