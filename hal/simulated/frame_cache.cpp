#include "hal/simulated/frame_cache.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

namespace wirepose::hal {

std::filesystem::path FrameCache::File(std::uint64_t sequence, const char* ending) const {
  return folder_ / (std::to_string(sequence) + ending);
}

std::optional<CachedFrame> FrameCache::Load(std::uint64_t sequence) const {
  // The truth is written last: where it is, the images are complete.
  std::ifstream in(File(sequence, ".json"), std::ios::binary);
  if (!in) return std::nullopt;
  const nlohmann::json json = nlohmann::json::parse(in, nullptr, false);
  auto left = dataset::ReadGrayPng(File(sequence, "_left.png")),
       right = dataset::ReadGrayPng(File(sequence, "_right.png"));
  if (!json.is_array() || !left || !right) return std::nullopt;
  CachedFrame frame{{*std::move(left), *std::move(right)}, {}};
  try {
    for (const nlohmann::json& object : json) {
      SimulatedObject o;
      o.obj_id = object.at("obj_id").get<int>();
      o.name = object.at("name").get<std::string>();
      o.visib_fract = object.at("visib_fract").get<double>();
      for (int i = 0; i < 9; ++i)
        o.T_camera_model.R(i / 3, i % 3) = object.at("R").at(static_cast<std::size_t>(i)).get<double>();
      for (int i = 0; i < 3; ++i) o.T_camera_model.t[i] = object.at("t").at(static_cast<std::size_t>(i)).get<double>();
      frame.objects.push_back(o);
    }
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
  return frame;
}

Result<void, std::string> FrameCache::Store(std::uint64_t sequence, const CachedFrame& frame) const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) return unexpected(folder_.string() + ": cannot be created: " + error.message() + "; choose another cache");
  for (const auto& [image, ending] :
       {std::pair(&frame.images.left, "_left.png"), std::pair(&frame.images.right, "_right.png")}) {
    const auto written = dataset::WriteGrayPng(File(sequence, ending), image->view());
    if (!written) return written;
  }
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const SimulatedObject& o : frame.objects) {
    nlohmann::ordered_json R = nlohmann::ordered_json::array();
    for (int i = 0; i < 9; ++i) R.push_back(o.T_camera_model.R(i / 3, i % 3));
    const Vector3d& t = o.T_camera_model.t;
    list.push_back({{"obj_id", o.obj_id},
                    {"name", o.name},
                    {"R", R},
                    {"t", {t.x(), t.y(), t.z()}},
                    {"visib_fract", o.visib_fract}});
  }
  std::ofstream out(File(sequence, ".json"), std::ios::binary);
  if (!(out << list.dump()) || !out.flush()) {
    return unexpected(File(sequence, ".json").string() + ": cannot be written; is the disk full?");
  }
  return {};
}

}  // namespace wirepose::hal
