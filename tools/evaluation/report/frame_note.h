// What the report shows of one frame, taken down while the recognizer still holds it.
#ifndef WIREPOSE_TOOLS_EVALUATION_REPORT_FRAME_NOTE_H_
#define WIREPOSE_TOOLS_EVALUATION_REPORT_FRAME_NOTE_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/image_view.h"
#include "tools/evaluation/evaluate.h"
#include "tools/evaluation/report/alarm_cause.h"
#include "tools/evaluation/score_curves.h"

namespace wirepose::evaluation {

// A reported detection, in the order of the result.
struct DetectionNote {
  nlohmann::ordered_json json;  // object, score, pose, evidence
  AlarmFacts facts;
};

struct FrameNote {
  nlohmann::ordered_json json;            // scene, image, width, height, picture, segments, lines
  std::vector<DetectionNote> detections;  // with score >= min_score
  std::vector<nlohmann::ordered_json>
      instances;                     // all true ones: object, visible, pose, nearest candidate, trace, cause
  std::vector<Estimate> unreported;  // see UnreportedCandidates
};

// Coordinates are pixels of the rectified left image, rounded to 0.1; a third number is the disparity there: what is to
// be subtracted from x in the right image.
//   pictures, segments  by eye, left and right; segments x0, y0, x1, y1 each; a picture that there is not is empty
//   lines               3D lines x0, y0, d0, x1, y1, d1; f_baseline over disparity is the depth, m
// Poses are drawn wireframes:
//   seen, hidden  ends x0, y0, d0, x1, y1, d1 of each piece of an edge
//   box           x0, y0, x1, y1 around the visible pieces, cut to the left image; null: nothing of it is in the image
// Error, one line: the picture could not be encoded.
Result<FrameNote, std::string> TakeNote(const FrameView& view, double min_score);

// Verified candidates that a lower threshold on the score would have reported: the best one of each place that is not a
// reported detection's. Which image edges belong to whom is not asked here, so a few more than selection would let
// pass.
std::vector<Estimate> UnreportedCandidates(const FrameView& view);

// Every verified candidate, reported or not: right when it lies within 0.1 diameters of an instance. Candidates on
// instances less visible than `min_visible_fraction` are left out.
std::vector<ScoredDetection> ScoredCandidates(const FrameView& view, double min_visible_fraction);

// As JPEG of quality 80 in a data URI; empty if it cannot be encoded.
std::string EncodePicture(ImageView image);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_REPORT_FRAME_NOTE_H_
