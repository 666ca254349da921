// A recognition result as bytes: every field, little-endian, in the order of declaration, without padding.
#ifndef WIREPOSE_TESTS_TARGETS_RESULT_BYTES_H_
#define WIREPOSE_TESTS_TARGETS_RESULT_BYTES_H_

#include <array>

#include "pipeline/recognition.h"

namespace wirepose::testing {

// Sink: anything with the Add functions of Digest.
template <typename Sink>
void Serialize(const RecognitionResult& result, Sink& sink) {
  sink.Add(static_cast<std::uint32_t>(result.detections.size()));
  for (const Detection& d : result.detections) {
    sink.Add(d.model_id, d.T_camera_model, d.covariance, d.score, d.visible_fraction, d.track_id);
    sink.Add(static_cast<std::uint32_t>(d.modes.size()));
    for (const PoseMode& mode : d.modes) sink.Add(mode.T_camera_model, mode.weight);
  }
  const RecognitionStatistics& s = result.statistics;
  for (const RecognitionList& named : kRecognitionLists) {
    const ListUse& list = s.*named.use;
    sink.Add(list.used, list.capacity, list.dropped);
  }
  sink.Add(result.budget_hit);
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_TARGETS_RESULT_BYTES_H_
