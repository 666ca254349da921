// Reads one mapping of a YAML file strictly: every error names file, line, key and remedy.
#ifndef WIREPOSE_YAML_YAML_SECTION_H_
#define WIREPOSE_YAML_YAML_SECTION_H_

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace wirepose::yaml {

// What is wrong with a file: "file:line: key: reason and remedy", one line.
struct YamlError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A mapping with the keys it may have. Read each key once, then call Finish: it refuses the keys
// that nobody asked for. A key that is absent leaves its variable as it is. All methods throw
// YamlError.
class YamlSection {
 public:
  // Parses a whole file of at most 1 MiB; its top level is the section.
  explicit YamlSection(const std::filesystem::path& file);

  // The mapping under `key`; an empty section when absent.
  [[nodiscard]] YamlSection Section(const std::string& key);
  // The mappings of the list under `key`; none when absent.
  [[nodiscard]] std::vector<YamlSection> Sections(const std::string& key);

  [[nodiscard]] bool Has(const std::string& key) const;

  // True when `key` is there.
  bool Read(const std::string& key, bool& value);
  bool Read(const std::string& key, std::string& value);
  bool Read(const std::string& key, std::int64_t& value, std::int64_t least, std::int64_t most);
  bool Read(const std::string& key, double& value, double least, double most);
  // One number, which is both then, or [low, high].
  bool ReadRange(const std::string& key, double& low, double& high, double least, double most);
  // One word or a list of words, none of them empty.
  bool Read(const std::string& key, std::vector<std::string>& value);
  // One number or a list of numbers.
  bool Read(const std::string& key, std::vector<double>& value, double least, double most);
  // Relative paths count from the folder of the file, so that a configuration works from
  // everywhere.
  bool Read(const std::string& key, std::filesystem::path& value);
  bool Read(const std::string& key, std::vector<std::filesystem::path>& value);
  bool Read(const std::string& key, std::vector<std::uint32_t>& value);

  void Finish() const;

  // Refuses the value of `key` (or its absence) with "file:line: key: reason".
  [[noreturn]] void Refuse(const std::string& key, const std::string& reason) const;

 private:
  YamlSection(std::filesystem::path file, std::string name, YAML::Node node);

  YAML::Node Find(const std::string& key);
  YAML::Node FindScalar(const std::string& key, const char* kind);
  YAML::Node FindList(const std::string& key, const char* kind);
  double Number(const YAML::Node& node, const std::string& key, double least, double most) const;
  [[nodiscard]] std::filesystem::path Resolve(const std::string& text) const;
  [[noreturn]] void RefuseAt(const YAML::Mark& mark, const std::string& key, const std::string& reason) const;

  std::filesystem::path file_;
  std::string name_;  // "camera.replay", "" at the top
  YAML::Node node_;
  std::set<std::string> known_;
};

}  // namespace wirepose::yaml

#endif  // WIREPOSE_YAML_YAML_SECTION_H_
