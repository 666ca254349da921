#include "hal/dataset/json_file.h"

#include <algorithm>
#include <fstream>

namespace wirepose::dataset {

Result<nlohmann::json, std::string> ReadJson(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return unexpected(path.string() + ": cannot be opened; check the data set");
  try {
    return nlohmann::json::parse(in);
  } catch (const nlohmann::json::exception& e) {
    std::string what = e.what();  // "[json.exception.parse_error.101] parse error at line 1, ..."
    const std::size_t bracket = what.find("] ");
    if (bracket != std::string::npos) what = what.substr(bracket + 2);
    std::replace(what.begin(), what.end(), '\n', ' ');
    return unexpected(path.string() + ": " + what + "; is the file complete? write it again");
  }
}

Result<void, std::string> WriteJson(const std::filesystem::path& path, const nlohmann::ordered_json& value) {
  std::ofstream file(path, std::ios::binary);
  if (!(file << value.dump(1) << "\n") || !file.flush()) {
    return unexpected(path.string() + ": cannot be written; check folder, permissions and free space");
  }
  return {};
}

}  // namespace wirepose::dataset
