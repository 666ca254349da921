// A whole evaluation as JSON.
#ifndef WIREPOSE_TOOLS_EVALUATION_EVALUATION_JSON_H_
#define WIREPOSE_TOOLS_EVALUATION_EVALUATION_JSON_H_

#include <nlohmann/json.hpp>

#include "tools/evaluation/evaluate.h"
#include "tools/evaluation/score_curves.h"

namespace wirepose::evaluation {

// The metrics (see metrics_json.h) and beside them:
//   calibration  reliability of the score: expected_error and bins (see score_curves.h; empty ones left out)
//   score_curve  precision and recall by threshold on the score
//   stages       by stage and for the whole "frame": wall_ms and cpu_ms, each with p50, p99 and max over all frames
//   lists        by bounded list: capacity, high_water, p50 of its use, dropped in all frames together
//   budget_hits  frames in which a bounded search stopped at its limit
//   per_frame    scene_id, im_id, time_s, cpu_s, detections, budget_hit, stages_ms, lists
nlohmann::ordered_json ToJson(const Evaluation& evaluation);

nlohmann::ordered_json ToJson(const Reliability& reliability);
nlohmann::ordered_json ToJson(const std::vector<CurvePoint>& curve);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_EVALUATION_JSON_H_
