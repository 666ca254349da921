#include "tools/evaluation/ply_vertices.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include <fmt/format.h>

namespace wirepose::evaluation {
namespace {

static_assert(std::endian::native == std::endian::little, "binary PLY is read in place");

struct Property {
  std::string name;
  std::string type;
};

struct Header {
  std::string format;
  std::size_t vertex_count = 0;
  std::vector<Property> properties;  // of the vertex element
};

unexpected<std::string> Fail(const std::filesystem::path& file, const std::string& what) {
  return unexpected<std::string>(
      fmt::format("{}: {}; export the mesh again as ASCII or binary little-endian PLY", file.string(), what));
}

// Size in bytes of a scalar type, 0 if PLY knows no such type.
std::size_t SizeOf(const std::string& type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "int" || type == "uint" || type == "int32" || type == "uint32") return 4;
  if (type == "float" || type == "float32") return 4;
  if (type == "double" || type == "float64") return 8;
  return 0;
}

std::optional<Header> ReadHeader(std::istream& in) {
  Header header;
  std::string line;
  std::string element;
  if (!std::getline(in, line) || line.substr(0, 3) != "ply") return std::nullopt;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "end_header") return header;
    if (key == "format") words >> header.format;
    if (key == "element") {
      words >> element;
      if (element == "vertex") words >> header.vertex_count;
    }
    if (key == "property" && element == "vertex") {
      Property& p = header.properties.emplace_back();
      words >> p.type >> p.name;
    }
    if (words.bad() || (words.fail() && !words.eof())) return std::nullopt;
  }
  return std::nullopt;
}

// Position of x, y and z among the properties.
std::optional<std::array<std::size_t, 3>> FindCoordinates(const Header& header) {
  std::array<std::size_t, 3> at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t i = 0;
    while (i < header.properties.size() && header.properties[i].name != std::string(1, "xyz"[axis])) ++i;
    if (i == header.properties.size()) return std::nullopt;
    at[axis] = i;
  }
  return at;
}

bool ReadAscii(std::istream& in, const Header& header, const std::array<std::size_t, 3>& at,
               std::vector<Vector3d>& vertices) {
  std::vector<double> record(header.properties.size());
  for (std::size_t n = 0; n < header.vertex_count; ++n) {
    for (double& value : record) {
      if (!(in >> value)) return false;
    }
    vertices.emplace_back(record[at[0]], record[at[1]], record[at[2]]);
  }
  return true;
}

double ScalarAt(const char* bytes, const std::string& type) {
  if (SizeOf(type) == 8) {
    double value;
    std::memcpy(&value, bytes, 8);
    return value;
  }
  float value;
  std::memcpy(&value, bytes, 4);
  return static_cast<double>(value);
}

bool ReadBinary(std::istream& in, const Header& header, const std::array<std::size_t, 3>& at,
                std::vector<Vector3d>& vertices) {
  std::vector<std::size_t> offsets;
  std::size_t stride = 0;
  for (const Property& p : header.properties) {
    offsets.push_back(stride);
    if (SizeOf(p.type) == 0) return false;
    stride += SizeOf(p.type);
  }
  for (std::size_t axis : at) {
    const std::string& type = header.properties[axis].type;
    if (type.find("float") == std::string::npos && type != "double") return false;
  }
  std::vector<char> record(stride);
  for (std::size_t n = 0; n < header.vertex_count; ++n) {
    if (!in.read(record.data(), static_cast<std::streamsize>(stride))) return false;
    Vector3d& v = vertices.emplace_back();
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t i = at[static_cast<std::size_t>(axis)];
      v[axis] = ScalarAt(record.data() + offsets[i], header.properties[i].type);
    }
  }
  return true;
}

}  // namespace

Result<std::vector<Vector3d>, std::string> ReadPlyVertices(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return Fail(file, "cannot be opened");
  const std::optional<Header> header = ReadHeader(in);
  if (!header) return Fail(file, "header: not a PLY header");
  const auto at = FindCoordinates(*header);
  if (!at) return Fail(file, "header: element vertex has no x, y and z");
  if (header->vertex_count == 0) return Fail(file, "header: no vertices");
  std::vector<Vector3d> vertices;
  const bool ascii = header->format == "ascii";
  if (!ascii && header->format != "binary_little_endian") {
    return Fail(file, "header: format '" + header->format + "' is not supported");
  }
  const bool ok = ascii ? ReadAscii(in, *header, *at, vertices) : ReadBinary(in, *header, *at, vertices);
  if (!ok) return Fail(file, fmt::format("vertex {}: missing or malformed", vertices.size()));
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    if (!vertices[n].allFinite()) return Fail(file, fmt::format("vertex {}: not finite", n));
  }
  return vertices;
}

}  // namespace wirepose::evaluation
