// What a false alarm was: how it relates to the objects that were really there.
#ifndef WIREPOSE_TOOLS_EVALUATION_REPORT_ALARM_CAUSE_H_
#define WIREPOSE_TOOLS_EVALUATION_REPORT_ALARM_CAUSE_H_

#include <optional>
#include <string_view>
#include <vector>

#include "hal/dataset/dataset.h"
#include "model/prepared_model.h"
#include "tools/evaluation/model_set.h"

namespace wirepose::evaluation {

enum class AlarmCause {
  kDuplicate,      // on an instance that another detection has found
  kWrongPose,      // on an instance of its object, but 0.1 diameters off or more
  kWrongDistance,  // covers an instance of its object in the image, nearer or farther: the size was taken wrong
  kOtherObject,    // on an instance of another known object
  kClutter,        // on something that is no known object
};
std::string_view CauseName(AlarmCause cause);

// A detection and the true instances of its frame. Instances by their index in the truth.
struct AlarmFacts {
  std::optional<std::size_t> nearest;  // of the same object, by vertex distance
  double nearest_error_d = 9;          // largest vertex distance to it modulo symmetry, in diameters; at most 9
  std::optional<std::size_t> covered;  // of the same object, seen in the same direction
  double range_ratio = 1;              // range of the detection over the range of `covered`
  std::optional<std::size_t> other;    // of another object, around the detection's centre
};

// `T_camera_model`: as detected, same frame as the truth (raw left camera). Instances whose model is not among `models`
// are passed over. O(instances * vertices * symmetries).
AlarmFacts RelateToTruth(const PreparedModel& model, const Pose& T_camera_model,
                         const std::vector<dataset::TrueInstance>& truth, const ModelSet& models);

// `nearest_is_found`: another detection was matched to `facts.nearest`.
AlarmCause CauseOf(const AlarmFacts& facts, bool nearest_is_found);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_REPORT_ALARM_CAUSE_H_
