// The section `dds` of the configuration.
#ifndef WIREPOSE_APP_DDS_CONFIG_H_
#define WIREPOSE_APP_DDS_CONFIG_H_

#include <string>

#include "app/stamp_clock.h"
#include "publish/bus.h"
#include "publish/dds_pool.h"
#include "yaml/yaml_section.h"

namespace wirepose::app {

struct DdsConfig {
  BusConfig bus;
  std::string frame_id = "wirepose_left_optical";
  StampSource stamp = StampSource::kSystem;
  std::size_t pool_bytes = kDefaultDdsPoolBytes;
};

// Reads and checks the whole section. Throws UsageError.
DdsConfig ReadDds(yaml::YamlSection section);

}  // namespace wirepose::app

#endif  // WIREPOSE_APP_DDS_CONFIG_H_
