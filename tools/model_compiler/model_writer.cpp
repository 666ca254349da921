#include "tools/model_compiler/model_writer.h"

#include <algorithm>
#include <cstring>
#include <span>

#include "model/crc32c.h"
#include "model/model_parser.h"

namespace wirepose::tools {
namespace {

template <typename Record>
ModelSection Append(const std::vector<Record>& records, std::vector<std::byte>& file) {
  const std::size_t offset = (file.size() + kModelAlignment - 1) / kModelAlignment * kModelAlignment;
  const auto bytes = std::as_bytes(std::span(records));
  file.resize(offset + bytes.size());
  std::copy(bytes.begin(), bytes.end(), file.begin() + static_cast<std::ptrdiff_t>(offset));
  return {static_cast<std::uint32_t>(offset), static_cast<std::uint32_t>(records.size())};
}

}  // namespace

std::vector<std::byte> WriteModel(const ModelRecords& records) {
  std::vector<std::byte> file(sizeof(ModelFileHeader));
  ModelFileHeader header{};
  header.magic = kModelMagic;
  header.version = kModelVersion;
  header.id = records.id;
  records.name.copy(header.name, kMaxModelName - 1);
  header.diameter_m = records.diameter_m;
  std::copy(records.box_min_m.begin(), records.box_min_m.end(), header.box_min_m);
  std::copy(records.box_max_m.begin(), records.box_max_m.end(), header.box_max_m);
  header.vertices = Append(records.vertices, file);
  header.triangles = Append(records.triangles, file);
  header.faces = Append(records.faces, file);
  header.edges = Append(records.edges, file);
  header.line_sets = Append(records.line_sets, file);
  header.set_members = Append(records.set_members, file);
  header.symmetries = Append(records.symmetries, file);
  header.aspects = Append(records.aspects, file);
  std::memcpy(file.data(), &header, sizeof header);
  SealModel(file);
  return file;
}

void SealModel(std::vector<std::byte>& file) {
  const auto size = static_cast<std::uint32_t>(file.size());
  std::memcpy(file.data() + offsetof(ModelFileHeader, file_size), &size, sizeof size);
  constexpr std::size_t kCrc = offsetof(ModelFileHeader, crc32c);
  const std::uint32_t crc = Crc32c(std::span<const std::byte>(file).subspan(kCrc + sizeof(std::uint32_t)));
  std::memcpy(file.data() + kCrc, &crc, sizeof crc);
}

}  // namespace wirepose::tools
