// The recognizer: a stereo pair in, known objects with their poses out.
#ifndef WIREPOSE_PIPELINE_RECOGNIZER_H_
#define WIREPOSE_PIPELINE_RECOGNIZER_H_

#include <cstdint>
#include <span>

#include "base/fixed_vector.h"
#include "base/image_view.h"
#include "capacities.h"
#include "geometry/camera.h"
#include "geometry/line3.h"
#include "geometry/segment2.h"
#include "model/model_view.h"
#include "pipeline/recognition.h"

namespace wirepose {

enum class [[nodiscard]] RecognizerError : std::uint8_t {
  kOk,
  kBadCalibration,   // a focal length or baseline that is not positive, a rotation that is none, distortion too strong
  kImageTooLarge,    // the calibration's image exceeds kMaxImageWidth x kMaxImageHeight or is smaller than 64 x 64
  kNotConfigured,    // Process before Configure
  kImageSizeMismatch,  // an image that is not of the calibrated size
  kTooManyModels,    // more than kMaxModels
  kDuplicateModel,   // two models of one id
};

// One line for people: what is wrong and what to do.
const char* Describe(RecognizerError error);

// Called after each stage of Process, on the caller's thread: for stage times and for looking at intermediates.
// The core reads no clock; who wants times takes them here.
class StageObserver {
 public:
  void StageDone(Stage stage) { DoStageDone(stage); }

 protected:
  ~StageObserver() = default;

 private:
  virtual void DoStageDone(Stage stage) = 0;
};

// All memory of the recognizer is part of this object: make it static. Not thread safe; no call allocates, blocks or
// reads a clock. The same calls with the same bytes give the same bytes on every target.
class Recognizer {
 public:
  // Computes the rectification. Keeps the models. Any previous calibration is replaced; on error nothing changes.
  RecognizerError Configure(const StereoCalibration& calibration);

  // Adds an object to search for. The bytes behind the view must stay unchanged until ClearModels.
  RecognizerError AddModel(const ModelView& model);
  void ClearModels();
  [[nodiscard]] std::span<const ModelView> models() const { return {models_.begin(), models_.end()}; }

  // Recognizes every added model in a raw pair of the calibrated size. `observer` may be null. Bounded time: every loop
  // has a compile-time bound; a search that stops at its bound sets `budget_hit`.
  RecognizerError Process(ImageView left, ImageView right, StageObserver* observer, RecognitionResult& result);

  // The rectified pair's camera and the rotation into it: p_rectified = T_rectified_raw * p_raw (rotation only).
  [[nodiscard]] const RectifiedCamera& camera() const { return camera_; }
  [[nodiscard]] const Pose& T_rectified_raw() const { return T_rectified_raw_; }

  // Intermediates of the last Process, for overlays and tests. Rectified left frame.
  [[nodiscard]] ImageView left_rectified() const { return {}; }
  [[nodiscard]] ImageView right_rectified() const { return {}; }
  [[nodiscard]] std::span<const Segment2> left_segments() const { return {}; }
  [[nodiscard]] std::span<const Line3> lines() const { return {}; }

 private:
  RectifiedCamera camera_;
  Pose T_rectified_raw_;
  FixedVector<ModelView, kMaxModels> models_;
};

}  // namespace wirepose

#endif  // WIREPOSE_PIPELINE_RECOGNIZER_H_
