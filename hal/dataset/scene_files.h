// The files of a scene that all layouts share. Used inside this room only.
#ifndef WIREPOSE_HAL_DATASET_SCENE_FILES_H_
#define WIREPOSE_HAL_DATASET_SCENE_FILES_H_

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hal/dataset/dataset.h"
#include "hal/dataset/malformed.h"

namespace wirepose::dataset {

// "000012" -> 12; nothing for a name that is no plain number. And back.
std::optional<int> NumberOf(const std::string& name);
std::string SixDigits(int number);

// One of a scene's JSON files: an object whose keys are image ids.
class SceneFile {
 public:
  // A file that does not exist lists no image.
  explicit SceneFile(const std::filesystem::path& path);

  [[noreturn]] void Fail(const std::string& place, const std::string& what) const;

  [[nodiscard]] std::string name() const { return std::filesystem::path(path_).filename().string(); }
  [[nodiscard]] const std::map<int, nlohmann::json>& frames() const { return frames_; }

  // The list of instances of one image; null when the file does not list the image.
  [[nodiscard]] const nlohmann::json* Instances(int im_id) const;

  [[nodiscard]] double Number(const nlohmann::json& instance, const std::string& place, const char* key) const;

  template <std::size_t kCount>
  [[nodiscard]] std::array<double, kCount> Numbers(const nlohmann::json& instance, const std::string& place,
                                                   const char* key) const {
    const auto found = instance.is_object() ? instance.find(key) : instance.end();
    std::array<double, kCount> numbers{};
    bool good = found != instance.end() && found->is_array() && found->size() == kCount;
    for (std::size_t i = 0; good && i < kCount; ++i) {
      good = (*found)[i].is_number() && std::isfinite((*found)[i].template get<double>());
      if (good) numbers[i] = (*found)[i].template get<double>();
    }
    if (!good) {
      Fail(place, std::string(key) + " is missing or not a list of " + std::to_string(kCount) +
                      " numbers; see the BOP layout");
    }
    return numbers;
  }

 private:
  std::string path_;
  std::map<int, nlohmann::json> frames_;
};

// What the scene's truth says about one frame; `info` may list nothing.
void ReadTruth(const SceneFile& gt, const SceneFile& info, FrameEntry& frame);

// Adds the numbers of the PNG files in a folder; a folder that does not exist has none.
void AddImageIds(const std::filesystem::path& folder, std::set<int>& im_ids);

// Reads ROOT/SPLIT scene by scene, in order of their numbers. The error is one line; an empty split is none.
using SceneReader = std::function<void(const std::filesystem::path& folder, int scene_id, std::vector<FrameEntry>&)>;
[[nodiscard]] Result<std::vector<FrameEntry>, std::string> ReadScenes(const std::filesystem::path& split,
                                                                      const SceneReader& read);

}  // namespace wirepose::dataset

#endif  // WIREPOSE_HAL_DATASET_SCENE_FILES_H_
