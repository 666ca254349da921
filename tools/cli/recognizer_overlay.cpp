#include "tools/cli/recognizer_overlay.h"

#include <opencv2/imgcodecs.hpp>

#include "tools/cli/command.h"

namespace wirepose::cli {

overlay::OverlayInput LinesOf(const Recognizer& recognizer) {
  overlay::OverlayInput input;
  input.left_rectified = recognizer.left_rectified();
  input.camera = recognizer.camera();
  input.segments = recognizer.left_segments();
  input.lines = recognizer.lines();
  for (std::uint32_t i = 0; i < recognizer.detection_count(); ++i) {
    for (const SetMember& member : recognizer.line_set(i)) input.line_sets.push_back({i, member.line});
  }
  return input;
}

void AddObject(const Recognizer& recognizer, const ModelView& model, const Pose& T_raw_model, overlay::PoseKind kind,
               const std::string& label, overlay::OverlayInput& input) {
  input.objects.push_back({model, recognizer.T_rectified_raw() * T_raw_model, kind, label});
}

void WriteOverlay(const overlay::OverlayInput& input, const std::filesystem::path& file) {
  if (input.left_rectified.data == nullptr) {
    throw WorkFailed(file.string() + ": there is no rectified image to draw on; process a frame first");
  }
  std::error_code ignored;  // a folder that cannot be made shows when the file is written
  std::filesystem::create_directories(file.parent_path(), ignored);
  bool written = false;
  try {
    written = cv::imwrite(file.string(), overlay::DrawOverlay(input));
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) {
    throw WorkFailed(file.string() + ": cannot be written; check the folder and the free space");
  }
}

}  // namespace wirepose::cli
