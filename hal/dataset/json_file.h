// JSON files of a data set. Used inside this room only.
#ifndef WIREPOSE_HAL_DATASET_JSON_FILE_H_
#define WIREPOSE_HAL_DATASET_JSON_FILE_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "base/result.h"
#include "geometry/se3.h"

namespace wirepose::dataset {

// The error is one line: "file: place: what; remedy".
[[nodiscard]] Result<nlohmann::json, std::string> ReadJson(const std::filesystem::path& path);
[[nodiscard]] Result<void, std::string> WriteJson(const std::filesystem::path& path,
                                                  const nlohmann::ordered_json& value);

}  // namespace wirepose::dataset

#endif  // WIREPOSE_HAL_DATASET_JSON_FILE_H_
