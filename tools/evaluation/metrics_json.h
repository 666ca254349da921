// Metrics as JSON: what regression tests and reports read.
#ifndef WIREPOSE_TOOLS_EVALUATION_METRICS_JSON_H_
#define WIREPOSE_TOOLS_EVALUATION_METRICS_JSON_H_

#include <nlohmann/json.hpp>

#include "tools/evaluation/metrics.h"

namespace wirepose::evaluation {

// Keys: frames, negative_frames, fp_per_negative_frame, rows, min_visib, time (frames with rows),
// per_object, per_scene, total; each object with instances, true_positives, false_positives,
// dont_care, recall, precision, fp_per_frame, recall_by_visibility, median_translation_mm,
// median_rotation_deg, AR_MSSD, AR_MSPD, nees. A rate without a denominator is null. Beyond that:
// instances (hit or missed, best error, range of the object's origin; of hits the errors, lateral_mm being the
// translation error across the line of sight) and false_positives, one entry each.
nlohmann::ordered_json ToJson(const Metrics& metrics);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_METRICS_JSON_H_
