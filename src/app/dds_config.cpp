#include "app/dds_config.h"

#include <algorithm>
#include <filesystem>

namespace wirepose::app {
namespace {

using yaml::YamlSection;

constexpr std::size_t kMaxFrameId = 63;  // bound of std_msgs::Header's frame_id in dds_idl
constexpr std::size_t kMaxTopicName = 255;
constexpr std::int64_t kMaxDeadline_ms = 60'000;

// What ROS 2 and DDS both allow.
bool IsTopicName(const std::string& name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '/';
  };
  return name.size() <= kMaxTopicName && name.front() != '/' && name.back() != '/' &&
         std::all_of(name.begin(), name.end(), allowed);
}

void ReadTopic(YamlSection section, const TopicSpec& spec, TopicSettings& settings) {
  std::int64_t depth = settings.depth;
  std::int64_t deadline_ms = settings.deadline.count();
  if (section.Read("name", settings.name) && !IsTopicName(settings.name)) {
    section.Refuse("name", "not a topic name; use letters, digits, _ and / between words, and rt/ first for ROS 2");
  }
  section.Read("reliable", settings.reliable);
  section.Read("depth", depth, 1, spec.max_depth);
  section.Read("deadline_ms", deadline_ms, 0, kMaxDeadline_ms);
  section.Finish();
  settings.depth = static_cast<std::int32_t>(depth);
  settings.deadline = std::chrono::milliseconds(deadline_ms);
}

void ReadTopics(YamlSection section, TopicTable& topics) {
  for (std::size_t i = 0; i < kTopicCount; ++i) {
    const TopicSpec& spec = Spec(static_cast<TopicId>(i));
    ReadTopic(section.Section(spec.key), spec, topics[i]);
    for (std::size_t other = 0; other < i; ++other) {
      if (topics[other].name == topics[i].name) section.Refuse(spec.key, "two topics have this name; choose another");
    }
  }
  section.Finish();
}

void ReadSecurity(YamlSection section, std::optional<SecurityFiles>& out) {
  SecurityFiles files;
  const struct {
    const char* key;
    std::string& file;
  } keys[] = {{"identity_ca", files.identity_ca},       {"certificate", files.certificate},
              {"private_key", files.private_key},       {"permissions_ca", files.permissions_ca},
              {"governance", files.governance},         {"permissions", files.permissions}};
  std::size_t found = 0;
  for (const auto& [key, file] : keys) {
    std::filesystem::path path;
    if (!section.Read(key, path)) continue;
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
      section.Refuse(key, "no such file; create the files with scripts/make-security");
    }
    file = path.string();
    ++found;
  }
  section.Finish();
  if (found == 0) return;
  for (const auto& [key, file] : keys) {
    if (file.empty()) section.Refuse(key, "missing; security needs all six files, or none");
  }
  out = files;
}

StampSource ReadStamp(YamlSection& section) {
  std::string stamp = "system";
  section.Read("stamp", stamp);
  if (stamp != "system" && stamp != "capture") section.Refuse("stamp", "neither system nor capture");
  return stamp == "system" ? StampSource::kSystem : StampSource::kCapture;
}

}  // namespace

DdsConfig ReadDds(YamlSection section) {
  DdsConfig config;
  std::int64_t domain = 0;
  section.Read("domain", domain, 0, kMaxDomain);
  section.Read("loopback", config.bus.loopback);
  section.Read("frame_id", config.frame_id);
  if (config.frame_id.size() > kMaxFrameId) section.Refuse("frame_id", "longer than 63 bytes");
  config.stamp = ReadStamp(section);
  ReadTopics(section.Section("topics"), config.bus.topics);
  ReadSecurity(section.Section("security"), config.bus.security);
  const std::size_t usual = config.bus.security ? kDefaultSecuredDdsPoolBytes : kDefaultDdsPoolBytes;
  std::int64_t pool_kib = static_cast<std::int64_t>(usual >> 10);
  section.Read("pool_kib", pool_kib, kMinDdsPoolBytes >> 10, kMaxDdsPoolBytes >> 10);
  section.Finish();
  config.bus.domain = static_cast<std::uint32_t>(domain);
  config.pool_bytes = static_cast<std::size_t>(pool_kib) << 10;
  return config;
}

}  // namespace wirepose::app
