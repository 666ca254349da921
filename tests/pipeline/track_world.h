// A world of moving boxes and a recognizer that errs: what the tracker is tested on.
#ifndef WIREPOSE_TESTS_PIPELINE_TRACK_WORLD_H_
#define WIREPOSE_TESTS_PIPELINE_TRACK_WORLD_H_

#include <memory>
#include <random>
#include <vector>

#include "model/symmetry.h"
#include "pipeline/tracker.h"

namespace wirepose::testing {

// What the tracker reads of a model: a cuboid of 0.3 x 0.2 x 0.15 m.
inline void MakeBox(std::uint32_t id, bool symmetric, PreparedModel& model) {
  model.view.id = id;
  model.view.checksum = 1000 + id;
  model.view.box_max_m = {0.15F, 0.1F, 0.075F};
  model.view.box_min_m = -model.view.box_max_m;
  model.view.diameter_m = 2 * model.view.box_max_m.norm();
  model.centre.setZero();
  for (unsigned i = 0; i < 8; ++i) {
    model.corners[i] = model.view.box_max_m.cwiseProduct(
        Vector3((i & 1U) != 0 ? 1.0F : -1.0F, (i & 2U) != 0 ? 1.0F : -1.0F, (i & 4U) != 0 ? 1.0F : -1.0F));
  }
  model.symmetries.push_back(Pose{});
  for (std::size_t k = 1; symmetric && k < 4; ++k) model.symmetries.push_back({BoxTurn(k), Vector3d::Zero()});
}

struct Noise {
  double rotation_rad = 0.007, lateral_m = 0.001, depth_m = 0.004;
  double misses = 0.15;        // of the detections
  double false_alarms = 0.05;  // a frame
  double turns = 0;            // an object that is no symmetric one is reported turned by 180 degrees
};

class TrackWorld {
 public:
  explicit TrackWorld(unsigned seed) : random_(seed) {
    models_->resize(2);
    MakeBox(1, true, (*models_)[0]);
    MakeBox(2, false, (*models_)[1]);
    scene.models = {models_->begin(), models_->end()};
    scene.searched = 3;
    scene.camera = {525, 320, 240, 0.12, 640, 480};
  }

  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double Gaussian(double sigma) { return std::normal_distribution<double>(0, sigma)(random_); }
  Vector3d AnyVector(double sigma) { return {Gaussian(sigma), Gaussian(sigma), Gaussian(sigma)}; }

  [[nodiscard]] Matrix6d Covariance(const Noise& noise) const {
    Vector6d sigma;
    sigma << Vector3d::Constant(noise.rotation_rad), noise.lateral_m, noise.lateral_m, noise.depth_m;
    return sigma.cwiseAbs2().asDiagonal();
  }

  // The object at T, measured with noise and turned by a symmetry that comes anew each time.
  Detection Measure(std::uint32_t model_id, const Pose& T, const Noise& noise) {
    const PreparedModel& model = (*models_)[model_id - 1];
    Vector6d twist;
    twist << AnyVector(noise.rotation_rad), Gaussian(noise.lateral_m), Gaussian(noise.lateral_m),
        Gaussian(noise.depth_m);
    Detection d;
    d.model_id = model_id;
    const auto s = std::uniform_int_distribution<std::size_t>(0, model.symmetries.size() - 1)(random_);
    d.T_camera_model = PerturbLeft(T, twist, T.t) * model.symmetries[s];
    if (Uniform(0, 1) < noise.turns) d.T_camera_model = d.T_camera_model * Pose{BoxTurn(3), Vector3d::Zero()};
    d.covariance = Covariance(noise);
    d.score = static_cast<float>(Uniform(0.6, 1));
    return d;
  }

  Detection FalseAlarm() {
    Detection d = Measure(1, {ExpSo3(AnyVector(1)), {Uniform(-0.5, 0.5), Uniform(-0.4, 0.4), Uniform(0.8, 2)}}, {});
    d.score = static_cast<float>(Uniform(0.5, 0.7));
    return d;
  }

  static CaptureTime Time(double seconds) {
    return CaptureTime(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * seconds)));
  }

  TrackingScene scene;

  PreparedModel& model(std::uint32_t id) { return (*models_)[id - 1]; }

 private:
  std::unique_ptr<FixedVector<PreparedModel, 2>> models_ = std::make_unique<FixedVector<PreparedModel, 2>>();
  std::mt19937_64 random_;
};

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_PIPELINE_TRACK_WORLD_H_
