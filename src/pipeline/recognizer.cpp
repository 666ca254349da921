#include "pipeline/recognizer.h"

namespace wirepose {

const char* StageName(Stage stage) {
  switch (stage) {
    case Stage::kRectify: return "rectify";
    case Stage::kSegments: return "segments";
    case Stage::kStereoLines: return "stereo_lines";
    case Stage::kLineSets: return "line_sets";
    case Stage::kCorrespondences: return "correspondences";
    case Stage::kHypotheses: return "hypotheses";
    case Stage::kVerify: return "verify";
    case Stage::kRefine: return "refine";
    case Stage::kSelect: return "select";
  }
  return "?";
}

const char* Describe(RecognizerError error) {
  switch (error) {
    case RecognizerError::kOk: return "ok";
    case RecognizerError::kBadCalibration:
      return "bad calibration: focal lengths and baseline must be positive and R a rotation; calibrate again";
    case RecognizerError::kImageTooLarge:
      return "calibrated image size is outside 64x64 to 640x480; bin or crop the camera image and calibrate at that size";
    case RecognizerError::kNotConfigured: return "no calibration; call Configure first";
    case RecognizerError::kImageSizeMismatch: return "the image is not of the calibrated size";
    case RecognizerError::kTooManyModels: return "too many models; at most 16 are searched for at once";
    case RecognizerError::kDuplicateModel: return "two models have the same id; rebuild one with another --id";
  }
  return "?";
}

RecognizerError Recognizer::Configure(const StereoCalibration& calibration) {
  camera_.width = calibration.width;
  camera_.height = calibration.height;
  return RecognizerError::kOk;
}

RecognizerError Recognizer::AddModel(const ModelView& model) {
  for (const ModelView& m : models_) {
    if (m.id == model.id) return RecognizerError::kDuplicateModel;
  }
  return models_.try_push_back(model) ? RecognizerError::kOk : RecognizerError::kTooManyModels;
}

void Recognizer::ClearModels() { models_.clear(); }

RecognizerError Recognizer::Process(ImageView, ImageView, StageObserver*, RecognitionResult& result) {
  result = {};
  return RecognizerError::kOk;
}

}  // namespace wirepose
