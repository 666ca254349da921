#include "tools/evaluation/report/alarm_cause.h"

#include <cmath>

#include "tools/evaluation/vertex_error.h"

namespace wirepose::evaluation {
namespace {

// Beyond half a diameter a pose shares no part worth the name with the object.
constexpr double kOnInstanceD = 0.5;
// Centres this near in the image, in diameters of the true object as it is seen, cover each other.
constexpr double kSameDirectionD = 0.25;
// A range that is wrong by more than this is a wrong size, not a wrong pose: the nearest look-alikes are 0.75 and 1.33.
constexpr double kWrongRange = 0.1;

Vector3d CentreOf(const ModelView& model, const Pose& T) {
  return T * (0.5F * (model.box_min_m + model.box_max_m)).cast<double>();
}

bool SameDirection(const Vector3d& detected, const Vector3d& truth, double diameter_m) {
  const Vector3d at_truth = detected * (truth.norm() / detected.norm());
  return (at_truth - truth).norm() < kSameDirectionD * diameter_m;
}

}  // namespace

std::string_view CauseName(AlarmCause cause) {
  switch (cause) {
    case AlarmCause::kDuplicate:
      return "duplicate";
    case AlarmCause::kWrongPose:
      return "wrong pose";
    case AlarmCause::kWrongDistance:
      return "wrong distance";
    case AlarmCause::kOtherObject:
      return "other object";
    case AlarmCause::kClutter:
      return "clutter";
  }
  return "?";
}

AlarmFacts RelateToTruth(const PreparedModel& model, const Pose& T_camera_model,
                         const std::vector<dataset::TrueInstance>& truth, const ModelSet& models) {
  AlarmFacts facts;
  const Vector3d detected = CentreOf(model.view, T_camera_model);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const ModelView* view = models.Find(static_cast<std::uint32_t>(truth[i].obj_id));
    if (view == nullptr) continue;
    const Vector3d centre = CentreOf(*view, truth[i].T_camera_model);
    const auto diameter = static_cast<double>(view->diameter_m);
    if (view->id != model.view.id) {
      if ((detected - centre).norm() < 0.5 * diameter) facts.other = i;
      continue;
    }
    const double error = RelativeVertexError(model, T_camera_model, truth[i].T_camera_model);
    if (!facts.nearest || error < facts.nearest_error_d) {
      facts.nearest = i;
      facts.nearest_error_d = error;
    }
    const double ratio = detected.norm() / centre.norm();
    if (!SameDirection(detected, centre, diameter) || std::abs(std::log(ratio)) < kWrongRange) continue;
    facts.covered = i;
    facts.range_ratio = ratio;
  }
  return facts;
}

AlarmCause CauseOf(const AlarmFacts& facts, bool nearest_is_found) {
  if (facts.nearest && facts.nearest_error_d < kOnInstanceD) {
    return nearest_is_found ? AlarmCause::kDuplicate : AlarmCause::kWrongPose;
  }
  if (facts.covered) return AlarmCause::kWrongDistance;
  return facts.other ? AlarmCause::kOtherObject : AlarmCause::kClutter;
}

}  // namespace wirepose::evaluation
