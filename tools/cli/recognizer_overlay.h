// From a recognizer that has just processed a frame to the picture of that frame.
#ifndef WIREPOSE_TOOLS_CLI_RECOGNIZER_OVERLAY_H_
#define WIREPOSE_TOOLS_CLI_RECOGNIZER_OVERLAY_H_

#include <filesystem>

#include "pipeline/recognizer.h"
#include "tools/overlay/overlay.h"

namespace wirepose::cli {

// Image, segments, lines and line sets of the last Process. The spans point into `recognizer`.
overlay::OverlayInput LinesOf(const Recognizer& recognizer);

// Adds a model at a pose that is given, as all of Wirepose's output is, in the raw left camera.
void AddObject(const Recognizer& recognizer, const ModelView& model, const Pose& T_raw_model, overlay::PoseKind kind,
               const std::string& label, overlay::OverlayInput& input);

// Draws and writes a PNG, making its folder. Throws WorkFailed.
void WriteOverlay(const overlay::OverlayInput& input, const std::filesystem::path& file);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_RECOGNIZER_OVERLAY_H_
