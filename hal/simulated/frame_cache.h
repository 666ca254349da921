// Rendered frames on disk, so that a scenario can be played faster than it is rendered. Used inside
// this room only.
#ifndef WIREPOSE_HAL_SIMULATED_FRAME_CACHE_H_
#define WIREPOSE_HAL_SIMULATED_FRAME_CACHE_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "hal/simulated/feed_faults.h"
#include "hal/simulated/simulated_camera.h"

namespace wirepose::hal {

struct CachedFrame {
  StereoImages images;
  std::vector<SimulatedObject> objects;
};

class FrameCache {
 public:
  // `folder` belongs to one scene of one scenario as rendered by this program: its name holds the
  // content hash. It is made when the first frame is stored.
  explicit FrameCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // Nothing when the frame is not there or cannot be read: it is rendered again then.
  [[nodiscard]] std::optional<CachedFrame> Load(std::uint64_t sequence) const;
  // The error is one line.
  [[nodiscard]] Result<void, std::string> Store(std::uint64_t sequence, const CachedFrame& frame) const;

 private:
  [[nodiscard]] std::filesystem::path File(std::uint64_t sequence, const char* ending) const;

  std::filesystem::path folder_;
};

}  // namespace wirepose::hal

#endif  // WIREPOSE_HAL_SIMULATED_FRAME_CACHE_H_
