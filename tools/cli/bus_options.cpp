#include "bus_options.h"

#include <filesystem>

#include "command.h"

namespace wirepose::cli {
namespace {

SecurityFiles FilesIn(const std::string& folder) {
  const auto file = [&](const char* name) {
    const std::filesystem::path path = std::filesystem::path(folder) / name;
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
      throw UsageError("--security " + folder + ": no " + name + " there; make the folder with scripts/make-security");
    }
    return path.string();
  };
  return {file("identity_ca.pem"),    file("certificate.pem"), file("key.pem"),
          file("permissions_ca.pem"), file("governance.p7s"),  file("permissions.p7s")};
}

}  // namespace

void AddBusOptions(CLI::App& command, BusOptions& options) {
  command.add_option("--domain", options.domain, "DDS domain")
      ->check(CLI::Range(0u, kMaxDomain))
      ->capture_default_str();
  command.add_flag("--loopback", options.loopback, "only this machine, as dds.loopback of wireposed");
  command.add_option("--name", options.names,
                     "KEY=NAME: the name of a topic, as dds.topics of wireposed; for example "
                     "detections=rt/robot1/detections; may be repeated");
  command.add_flag("--best-effort", options.best_effort,
                   "ask for best-effort delivery: needed where dds.topics says reliable: false");
  command.add_option("--security", options.security, "a participant's folder, as scripts/make-security makes it");
}

BusConfig BusConfigOf(const BusOptions& options) {
  BusConfig config;
  config.domain = options.domain;
  config.loopback = options.loopback;
  for (TopicSettings& topic : config.topics) topic.reliable = !options.best_effort;
  config.topics[static_cast<std::size_t>(TopicId::kRecognition)].deadline =
      std::chrono::milliseconds(options.deadline_ms);
  for (const std::string& text : options.names) {
    const std::size_t equals = text.find('=');
    bool known = false;
    for (std::size_t i = 0; i < kTopicCount && equals != std::string::npos; ++i) {
      if (text.substr(0, equals) != Spec(static_cast<TopicId>(i)).key) continue;
      config.topics[i].name = text.substr(equals + 1);
      known = true;
    }
    if (!known) throw UsageError("--name " + text + ": not KEY=NAME with the key of a topic; see dds.topics");
  }
  if (!options.security.empty()) config.security = FilesIn(options.security);
  return config;
}

Bus OpenBus(const BusOptions& options) {
  Result<Bus, std::string> bus = Bus::Open(BusConfigOf(options));
  if (!bus) throw WorkFailed(bus.error());
  return *std::move(bus);
}

dds_entity_t OpenReader(const Bus& bus, TopicId topic) {
  const Result<dds_entity_t, std::string> reader = bus.CreateReader(topic);
  if (!reader) throw WorkFailed(reader.error());
  return *reader;
}

std::string Where(const BusOptions& options) {
  return "DDS domain " + std::to_string(options.domain) + (options.loopback ? " (loopback)" : "");
}

}  // namespace wirepose::cli
