#include "yaml/yaml_section.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

namespace wirepose::yaml {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 1 << 20;

std::string ReadWhole(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw YamlError(file.string() + ": no such file; check the path");
  }
  if (std::filesystem::file_size(file, error) > kMaxFileBytes || error) {
    throw YamlError(file.string() + ": larger than 1 MiB; give a file of settings");
  }
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw YamlError(file.string() + ": cannot be read; check its permissions");
  return text.str();
}

// Keys and words of a damaged file may hold anything; a message is one short line.
std::string OneLine(std::string text) {
  constexpr std::size_t kMaxBytes = 300;
  if (text.size() > kMaxBytes) text.replace(kMaxBytes, std::string::npos, "...");
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7F') c = '?';
  }
  return text;
}

YAML::Node Parse(const std::filesystem::path& file) {
  try {
    return YAML::Load(ReadWhole(file));
  } catch (const YAML::Exception& e) {
    throw YamlError(file.string() + ":" + std::to_string(e.mark.line + 1) + ": not YAML: " + OneLine(e.msg) +
                    "; correct the line");
  }
}

template <typename T>
bool ParseNumber(const std::string& text, T& value) {
  const char* const end = text.data() + text.size();
  const std::from_chars_result result = std::from_chars(text.data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

std::string Quoted(const std::string& text) {
  std::string quoted("'");
  return quoted.append(text).append("'");
}

std::string Text(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

}  // namespace

YamlSection::YamlSection(const std::filesystem::path& file) : YamlSection(file, "", Parse(file)) {}

YamlSection::YamlSection(std::filesystem::path file, std::string name, YAML::Node node)
    : file_(std::move(file)), name_(std::move(name)), node_(std::move(node)) {
  if (!node_ || node_.IsNull()) return;
  if (!node_.IsMap()) RefuseAt(node_.Mark(), "", "not a mapping; write 'key: value' lines");
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) RefuseAt(entry.first.Mark(), "", "a key must be a plain word");
    if (!seen.insert(entry.first.Scalar()).second) {
      RefuseAt(entry.first.Mark(), entry.first.Scalar(), "stands here twice; remove one");
    }
  }
}

YamlSection YamlSection::Section(const std::string& key) {
  return {file_, name_.empty() ? key : name_ + "." + key, Find(key)};
}

std::vector<YamlSection> YamlSection::Sections(const std::string& key) {
  std::vector<YamlSection> sections;
  const YAML::Node list = FindList(key, "a list of mappings");
  if (!list) return sections;
  for (const YAML::Node& item : list) {
    std::string name = name_.empty() ? key : name_ + "." + key;
    name.append("[").append(std::to_string(sections.size())).append("]");
    if (!item.IsMap()) RefuseAt(item.Mark(), key, "not a mapping; write 'key: value' lines");
    sections.push_back({file_, name, item});
  }
  return sections;
}

bool YamlSection::Has(const std::string& key) const {
  const YAML::Node& node = node_;
  return node && node.IsMap() && node[key];
}

bool YamlSection::Read(const std::string& key, bool& value) {
  const YAML::Node node = FindScalar(key, "true or false");
  if (!node) return false;
  if (node.Scalar() != "true" && node.Scalar() != "false") {
    Refuse(key, Quoted(node.Scalar()) + " is not a truth value; write true or false");
  }
  value = node.Scalar() == "true";
  return true;
}

bool YamlSection::Read(const std::string& key, std::string& value) {
  const YAML::Node node = FindScalar(key, "a word");
  if (!node) return false;
  if (node.Scalar().empty()) Refuse(key, "empty; write a value or remove the line");
  value = node.Scalar();
  return true;
}

bool YamlSection::Read(const std::string& key, std::int64_t& value, std::int64_t least, std::int64_t most) {
  const YAML::Node node = FindScalar(key, "a whole number");
  if (!node) return false;
  std::int64_t number = 0;
  if (!ParseNumber(node.Scalar(), number) || number < least || number > most) {
    Refuse(key, Quoted(node.Scalar()) + " is not a whole number from " + std::to_string(least) + " to " +
                    std::to_string(most));
  }
  value = number;
  return true;
}

bool YamlSection::Read(const std::string& key, double& value, double least, double most) {
  const YAML::Node node = FindScalar(key, "a number");
  if (!node) return false;
  value = Number(node, key, least, most);
  return true;
}

bool YamlSection::ReadRange(const std::string& key, double& low, double& high, double least, double most) {
  const YAML::Node node = Find(key);
  if (!node) return false;
  if (node.IsScalar()) {
    low = high = Number(node, key, least, most);
    return true;
  }
  if (!node.IsSequence() || node.size() != 2) Refuse(key, "needs a number or two of them, as [low, high]");
  const double first = Number(node[0], key, least, most), second = Number(node[1], key, least, most);
  if (first > second) Refuse(key, "begins with the greater number; write [low, high]");
  low = first;
  high = second;
  return true;
}

bool YamlSection::Read(const std::string& key, std::vector<std::string>& value) {
  const YAML::Node node = Find(key);
  if (!node) return false;
  std::vector<std::string> words;
  if (node.IsScalar()) words.push_back(node.Scalar());
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) words.push_back(item.IsScalar() ? item.Scalar() : std::string());
  }
  for (const std::string& word : words) {
    if (word.empty()) Refuse(key, "needs a word or a list of words, as [a, b]");
  }
  if (words.empty()) Refuse(key, "needs a word or a list of words, as [a, b]");
  value = words;
  return true;
}

bool YamlSection::Read(const std::string& key, std::vector<double>& value, double least, double most) {
  const YAML::Node node = Find(key);
  if (!node) return false;
  value.clear();
  if (node.IsScalar()) value.push_back(Number(node, key, least, most));
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) value.push_back(Number(item, key, least, most));
  }
  if (value.empty()) Refuse(key, "needs a number or a list of numbers, as [1, 2]");
  return true;
}

bool YamlSection::Read(const std::string& key, std::filesystem::path& value) {
  std::string text;
  if (!Read(key, text)) return false;
  value = Resolve(text);
  return true;
}

bool YamlSection::Read(const std::string& key, std::vector<std::filesystem::path>& value) {
  const YAML::Node node = FindList(key, "a list of paths");
  if (!node) return false;
  value.clear();
  for (const YAML::Node& item : node) {
    if (!item.IsScalar() || item.Scalar().empty()) RefuseAt(item.Mark(), key, "not a path");
    value.push_back(Resolve(item.Scalar()));
  }
  return true;
}

bool YamlSection::Read(const std::string& key, std::vector<std::uint32_t>& value) {
  const YAML::Node node = FindList(key, "a list of model ids");
  if (!node) return false;
  value.clear();
  for (const YAML::Node& item : node) {
    std::uint32_t number = 0;
    if (!item.IsScalar() || !ParseNumber(item.Scalar(), number)) {
      RefuseAt(item.Mark(), key, "not a model id; write whole numbers");
    }
    value.push_back(number);
  }
  return true;
}

void YamlSection::Finish() const {
  if (!node_ || node_.IsNull()) return;
  for (const auto& entry : node_) {
    const std::string& key = entry.first.Scalar();
    if (known_.contains(key)) continue;
    std::string keys;
    for (const std::string& name : known_) {
      if (!keys.empty()) keys.append(", ");
      keys.append(name);
    }
    RefuseAt(entry.first.Mark(), key, "unknown key; known here: " + keys);
  }
}

void YamlSection::Refuse(const std::string& key, const std::string& reason) const {
  const YAML::Node& node = node_;
  const bool present = node && node.IsMap() && node[key];
  RefuseAt(present ? node[key].Mark() : (node ? node.Mark() : YAML::Mark::null_mark()), key, reason);
}

YAML::Node YamlSection::Find(const std::string& key) {
  known_.insert(key);
  if (!node_ || !node_.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
  const YAML::Node& node = node_;  // the const operator[] adds nothing to the mapping
  return node[key];
}

YAML::Node YamlSection::FindScalar(const std::string& key, const char* kind) {
  YAML::Node node = Find(key);
  if (node && !node.IsScalar()) Refuse(key, std::string("needs ") + kind);
  return node;
}

YAML::Node YamlSection::FindList(const std::string& key, const char* kind) {
  YAML::Node node = Find(key);
  if (node && !node.IsSequence()) Refuse(key, std::string("needs ") + kind + ", as [a, b]");
  return node;
}

double YamlSection::Number(const YAML::Node& node, const std::string& key, double least, double most) const {
  double number = 0;
  const bool is_number = node.IsScalar() && ParseNumber(node.Scalar(), number);
  // The negated comparison refuses "nan" too.
  if (!is_number || !(number >= least && number <= most)) {
    const std::string what = node.IsScalar() ? Quoted(node.Scalar()) : "this";
    RefuseAt(node.Mark(), key, what + " is not a number from " + Text(least) + " to " + Text(most));
  }
  return number;
}

std::filesystem::path YamlSection::Resolve(const std::string& text) const {
  const std::filesystem::path path(text);
  return path.is_absolute() ? path : (file_.parent_path() / path).lexically_normal();
}

void YamlSection::RefuseAt(const YAML::Mark& mark, const std::string& key, const std::string& reason) const {
  std::string place = file_.string();
  if (!mark.is_null()) place.append(":").append(std::to_string(mark.line + 1));
  std::string name = name_;
  if (!name.empty() && !key.empty()) name.append(".");
  name.append(key);
  if (!name.empty()) name.append(": ");
  throw YamlError(place + ": " + OneLine(name + reason));
}

}  // namespace wirepose::yaml
