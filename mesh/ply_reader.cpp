#include "mesh/ply_reader.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <vector>

#include "mesh/polygon.h"

namespace wirepose::mesh {
namespace {

constexpr std::size_t kMaxPolygon = 1000;  // corners; ear clipping is cubic

enum class Encoding : std::uint8_t { kAscii, kLittleEndian, kBigEndian };
enum class Type : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct Property {
  std::string name;
  Type type;
  bool is_list = false;
  Type count_type = Type::kUint8;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::kAscii;
  std::vector<Element> elements;
  std::size_t size = 0;  // bytes, up to the data
};

std::string At(std::size_t line) { return "line " + std::to_string(line) + ": "; }

bool ParseType(const std::string& name, Type& type) {
  const std::pair<const char*, Type> names[] = {
      {"char", Type::kInt8},   {"int8", Type::kInt8},     {"uchar", Type::kUint8},   {"uint8", Type::kUint8},
      {"short", Type::kInt16}, {"int16", Type::kInt16},   {"ushort", Type::kUint16}, {"uint16", Type::kUint16},
      {"int", Type::kInt32},   {"int32", Type::kInt32},   {"uint", Type::kUint32},   {"uint32", Type::kUint32},
      {"float", Type::kFloat}, {"float32", Type::kFloat}, {"double", Type::kDouble}, {"float64", Type::kDouble}};
  const auto* it = std::find_if(std::begin(names), std::end(names), [&](const auto& n) { return name == n.first; });
  if (it == std::end(names)) return false;
  type = it->second;
  return true;
}

bool ParseFormat(std::istringstream& words, Encoding& encoding) {
  std::string format, version;
  words >> format >> version;
  if (version != "1.0") return false;
  if (format == "ascii") {
    encoding = Encoding::kAscii;
  } else if (format == "binary_little_endian") {
    encoding = Encoding::kLittleEndian;
  } else if (format == "binary_big_endian") {
    encoding = Encoding::kBigEndian;
  } else {
    return false;
  }
  return true;
}

bool ParseProperty(std::istringstream& words, Property& property) {
  std::string type, count_type;
  words >> type;
  if (type == "list") {
    property.is_list = true;
    words >> count_type >> type;
    if (!ParseType(count_type, property.count_type)) return false;
  }
  words >> property.name;
  return ParseType(type, property.type) && !property.name.empty();
}

// One line of the header; false if it makes no sense.
bool ParseHeaderLine(const std::string& line, std::size_t file_size, Header& header) {
  std::istringstream words(line);
  std::string keyword;
  words >> keyword;
  if (keyword == "comment" || keyword == "obj_info") return true;
  if (keyword == "format") return ParseFormat(words, header.encoding);
  if (keyword == "element") {
    Element element;
    words >> element.name >> element.count;
    if (!words || element.count > file_size) return false;  // each record takes at least a byte
    header.elements.push_back(element);
    return true;
  }
  if (keyword != "property" || header.elements.empty()) return false;
  Property property{};
  if (!ParseProperty(words, property)) return false;
  header.elements.back().properties.push_back(property);
  return true;
}

Result<Header, std::string> ParseHeader(std::string_view file) {
  Header header;
  std::size_t begin = 0;
  for (std::size_t line_number = 1;; ++line_number) {
    const std::size_t end = file.find('\n', begin);
    if (end == std::string_view::npos) {
      return unexpected(
          std::string("the PLY header has no end_header; the file is truncated or no PLY: export it again"));
    }
    std::string line(file.substr(begin, end - begin));
    if (!line.empty() && line.back() == '\r') line.pop_back();
    begin = end + 1;
    if (line_number == 1) {
      if (line != "ply") return unexpected(std::string("not a PLY file; give it the extension of its format"));
    } else if (line == "end_header") {
      header.size = begin;
      return header;
    } else if (!ParseHeaderLine(line, file.size(), header)) {
      return unexpected(At(line_number) + "not understood in a PLY 1.0 header; export the mesh again");
    }
  }
}

// Hands out the numbers of the data part one by one.
class NumberReader {
 public:
  NumberReader(std::string_view data, Encoding encoding) : data_(data), encoding_(encoding) {}

  bool Next(Type type, double& value) {
    return encoding_ == Encoding::kAscii ? NextText(value) : NextBinary(type, value);
  }
  [[nodiscard]] std::size_t bytes_left() const { return data_.size() - at_; }

 private:
  bool NextText(double& value) {
    constexpr std::string_view kSpace = " \t\r\n";
    at_ = std::min(data_.find_first_not_of(kSpace, at_), data_.size());
    const std::size_t end = std::min(data_.find_first_of(kSpace, at_), data_.size());
    std::string_view word = data_.substr(at_, end - at_);
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    at_ = end;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && rest == word.data() + word.size();
  }

  template <typename T>
  bool Take(double& value) {
    if (bytes_left() < sizeof(T)) return false;
    std::array<char, sizeof(T)> bytes{};
    std::copy_n(data_.data() + at_, sizeof(T), bytes.begin());
    at_ += sizeof(T);
    if ((encoding_ == Encoding::kBigEndian) != (std::endian::native == std::endian::big)) {
      std::reverse(bytes.begin(), bytes.end());
    }
    value = static_cast<double>(std::bit_cast<T>(bytes));
    return true;
  }

  bool NextBinary(Type type, double& value) {
    switch (type) {
      case Type::kInt8:
        return Take<std::int8_t>(value);
      case Type::kUint8:
        return Take<std::uint8_t>(value);
      case Type::kInt16:
        return Take<std::int16_t>(value);
      case Type::kUint16:
        return Take<std::uint16_t>(value);
      case Type::kInt32:
        return Take<std::int32_t>(value);
      case Type::kUint32:
        return Take<std::uint32_t>(value);
      case Type::kFloat:
        return Take<float>(value);
      case Type::kDouble:
        return Take<double>(value);
    }
    return false;
  }

  std::string_view data_;
  Encoding encoding_;
  std::size_t at_ = 0;
};

// One property of one record: a number, or a list of them.
bool ReadProperty(NumberReader& reader, const Property& property, std::vector<double>& values) {
  double count = 1;
  if (property.is_list && !reader.Next(property.count_type, count)) return false;
  if (!(count >= 0 && count <= static_cast<double>(reader.bytes_left())) || count != std::floor(count)) return false;
  values.resize(static_cast<std::size_t>(count));
  return std::all_of(values.begin(), values.end(), [&](double& v) { return reader.Next(property.type, v); });
}

bool AddPolygon(const std::vector<double>& corners, Mesh& mesh) {
  if (corners.size() < 3 || corners.size() > kMaxPolygon) return false;
  std::vector<int> polygon;
  for (const double c : corners) {
    if (!(c >= 0 && c < static_cast<double>(mesh.vertices.size())) || c != std::floor(c)) return false;
    polygon.push_back(static_cast<int>(c));
  }
  AppendPolygon(polygon, mesh);
  return true;
}

// One record; false if it is truncated or makes no sense.
bool ReadRecord(NumberReader& reader, const Element& element, double metres_per_unit, Mesh& mesh) {
  Eigen::Vector3d position(NAN, NAN, NAN);
  std::vector<double> values, corners;
  for (const Property& property : element.properties) {
    if (!ReadProperty(reader, property, values)) return false;
    if (property.is_list) {
      if (property.name == "vertex_indices" || property.name == "vertex_index") corners = values;
    } else if (property.name == "x" || property.name == "y" || property.name == "z") {
      position[property.name[0] - 'x'] = values[0] * metres_per_unit;
    }
  }
  if (element.name == "vertex") {
    mesh.vertices.push_back(position);
    return position.allFinite();
  }
  return element.name != "face" || AddPolygon(corners, mesh);
}

}  // namespace

Result<Mesh, std::string> ParsePly(std::string_view file, double metres_per_unit) {
  const auto header = ParseHeader(file);
  if (!header) return unexpected(header.error());
  NumberReader reader(file.substr(header->size), header->encoding);
  Mesh mesh;
  for (const Element& element : header->elements) {
    for (std::size_t i = 0; i < element.count; ++i) {
      if (ReadRecord(reader, element, metres_per_unit, mesh)) continue;
      return unexpected(element.name + " " + std::to_string(i) + " of " + std::to_string(element.count) +
                        " is truncated or invalid; export the mesh again");
    }
  }
  return mesh;
}

}  // namespace wirepose::mesh
