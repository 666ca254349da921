#include "sim/scenario.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/layout.h"
#include "sim/random.h"

namespace wirepose::sim {
namespace {

constexpr int kMaxLayouts = 60;

// A camera at `eye` that looks at `target`, its x axis level before it is rolled.
Pose LookAt(const Vector3d& eye, const Vector3d& target, double roll_rad) {
  const Vector3d z = (target - eye).normalized();
  const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
  Pose T_world_camera;
  T_world_camera.R << x, z.cross(x), z;
  T_world_camera.R = (T_world_camera.R * Eigen::AngleAxisd(roll_rad, Vector3d::UnitZ()).toRotationMatrix()).eval();
  T_world_camera.t = eye;
  return T_world_camera;
}

// The middle of all objects that have truth; the worktop where there is none.
Vector3d MiddleOf(const Scene& scene, const std::vector<Placed>& placed) {
  Vector3d middle(0, 0, 0.08);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Vector3d& t = scene.instances[static_cast<std::size_t>(placed[i].instance)].T_world_object.t;
    middle = i == 0 ? t : Vector3d(middle + t);
  }
  return middle / std::max<double>(1, static_cast<double>(placed.size()));
}

// The middle of the baseline looks at the objects, so that both eyes see them.
void AimCamera(Random& random, const CameraSpec& spec, const Room& room, Scenario& scenario) {
  for (int i = 0; i < 3; ++i) scenario.look_at[i] += (i == 2 ? 0.5 : 1.0) * Draw(random, spec.aim_m);
  const double down = Draw(random, spec.elevation_deg) * kDegree;
  const double around = Draw(random, spec.azimuth_deg) * kDegree;
  const double distance = Draw(random, spec.distance_m);
  const Vector3d back(std::sin(around) * std::cos(down), -std::cos(around) * std::cos(down), std::sin(down));
  Vector3d eye = scenario.look_at + distance * back;
  eye.z() = std::clamp(eye.z(), room.floor_z + 0.3, room.ceiling_z - 0.15);
  eye.y() = std::max(eye.y(), -3.8);
  Pose T = LookAt(eye, scenario.look_at, Draw(random, spec.roll_deg) * kDegree);
  T.t -= 0.5 * spec.calibration.T_right_left.t.norm() * T.R.col(0);
  scenario.rig.calibration = spec.calibration;
  scenario.rig.T_world_left = T;
}

void SetSensors(Random& random, const SensorSpec& spec, StereoRig& rig) {
  Sensor sensor;
  sensor.full_well_e = DrawFloat(random, spec.white_e);
  sensor.read_noise_e = DrawFloat(random, spec.read_noise_e);
  sensor.dark_e = static_cast<float>(spec.dark_e);
  sensor.prnu = static_cast<float>(spec.prnu);
  sensor.dsnu_e = static_cast<float>(spec.dsnu_e);
  sensor.gamma = static_cast<float>(DrawOne(random, spec.gamma));
  sensor.veil = DrawFloat(random, spec.veil);
  rig.left_sensor = rig.right_sensor = sensor;
  rig.left_sensor.gain = 1;
  rig.left_sensor.serial = 1;
  rig.right_sensor.gain = DrawFloat(random, spec.right_gain);
  rig.right_sensor.serial = 2;
  rig.exposure_target = DrawFloat(random, spec.brightness);
  rig.exposure_s = Draw(random, spec.exposure_ms) / 1000;
  rig.psf_sigma_px = Draw(random, spec.psf_sigma_px);
  rig.right_psf_sigma_px = Draw(random, spec.psf_sigma_px);
  rig.vignetting = Draw(random, spec.vignetting);
}

struct Draft {
  Scenario scenario;
  std::vector<Placed> placed;
};

Draft DrawScene(const ScenarioSpec& spec, std::uint64_t seed, const std::vector<TargetMesh>& targets) {
  Random random(seed);
  Draft draft;
  Scenario& scenario = draft.scenario;
  SceneBuilder builder(scenario.scene);
  const bool needs_bay = std::any_of(spec.objects.begin(), spec.objects.end(),
                                     [](const ObjectSpec& o) { return o.on == Support::kFloor; });
  const Room room = BuildRoom(random, spec.room, needs_bay, builder);
  AddLights(random, spec.lights, room, scenario.scene);
  Layout layout(random, builder, room);
  layout.PlaceObjects(spec.objects, targets);
  scenario.look_at = MiddleOf(scenario.scene, layout.placed());
  AimCamera(random, spec.camera, room, scenario);
  layout.PlaceOccluders(spec.clutter, scenario.rig.T_world_left.t);
  layout.PlaceClutter(spec.clutter);
  SetSensors(random, spec.sensor, scenario.rig);
  scenario.motion = {spec.path.kind, Draw(random, spec.path.speed_m_per_s), Draw(random, spec.path.shake_deg) * kDegree,
                     random.Next()};
  draft.placed = layout.placed();
  return draft;
}

Camera Coarse(Camera camera) {
  constexpr int kFactor = 4;
  camera.width /= kFactor;
  camera.height /= kFactor;
  for (double* length : {&camera.intrinsics.fx, &camera.intrinsics.fy, &camera.intrinsics.cx, &camera.intrinsics.cy}) {
    *length /= kFactor;
  }
  return camera;
}

// How far the objects' visible fractions are from those wanted, added up.
double Violation(const Draft& draft) {
  if (draft.placed.empty()) return 0;
  const Renderer renderer(draft.scenario.scene);
  const Truth truth = FindTruth(renderer, Coarse(LeftCamera(draft.scenario.rig)), 1);
  double sum = 0;
  for (const ObjectTruth& object : truth.objects) {
    const auto placed = std::find_if(draft.placed.begin(), draft.placed.end(),
                                     [&](const Placed& p) { return p.instance == object.instance; });
    if (placed == draft.placed.end()) continue;
    const Range& wanted = placed->spec->visible;
    sum += std::max({0.0, wanted.low - object.visib_fract, object.visib_fract - wanted.high});
  }
  return sum;
}

// Instances that found no room count as a violation too.
int Missing(const ScenarioSpec& spec, const Draft& draft) {
  double least = 0;
  for (const ObjectSpec& object : spec.objects) least += object.is_look_alike ? 0 : std::floor(object.count.low);
  return std::max(0, static_cast<int>(least) - static_cast<int>(draft.placed.size()));
}

std::string NamesOf(const std::vector<TargetMesh>& targets) {
  std::string names;
  for (const TargetMesh& target : targets) names += (names.empty() ? "" : ", ") + target.name;
  return names.empty() ? "none" : names;
}

Result<void, std::string> CheckModels(const ScenarioSpec& spec, const std::vector<TargetMesh>& targets) {
  for (const ObjectSpec& object : spec.objects) {
    for (const std::string& name : object.models) {
      const bool is_known =
          std::any_of(targets.begin(), targets.end(), [&](const TargetMesh& t) { return t.name == name; });
      if (!is_known) {
        return unexpected("scenario " + spec.name + ": no model '" + name + "' among the meshes; there are " +
                          NamesOf(targets));
      }
    }
    const bool fits =
        std::any_of(targets.begin(), targets.end(), [&](const TargetMesh& t) { return FitsOn(object.on, t); });
    if (object.models.empty() && !fits) {
      return unexpected("scenario " + spec.name +
                        ": no mesh is small enough for a worktop (0.6 m); add one, and check " +
                        "that the meshes are in millimetres");
    }
  }
  return {};
}

// A turn that wanders between -1 and 1, with a few oscillations a second.
double Shake(std::uint64_t seed, int axis, double time_s) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t h = Mix(seed, static_cast<std::uint64_t>(3 * axis + i));
    const double frequency = 5 + 4 * double{UnitFloat(h)}, phase = 2 * std::numbers::pi * double{UnitFloat(h << 24)};
    sum += std::sin(2 * std::numbers::pi * frequency * time_s + phase) - std::sin(phase);
  }
  return sum / 3;
}

}  // namespace

namespace {

Pose PoseAt(const Scenario& s, double time_s) {
  Pose T = s.rig.T_world_left;
  const double distance = std::max((T.t - s.look_at).norm(), 0.1);
  if (s.motion.kind == PathKind::kOrbit) {
    constexpr double kSwing = 0.3, kBob = 0.05;  // rad
    const double rate = s.motion.speed_m_per_s / distance;
    const double around = kSwing * std::sin(rate / kSwing * time_s);
    const double up = kBob * std::sin(0.5 * time_s);
    const Vector3d x = T.R.col(0);
    const Matrix3d R = (Eigen::AngleAxisd(around, Vector3d::UnitZ()) * Eigen::AngleAxisd(up, x)).toRotationMatrix();
    T = Pose{R, s.look_at - R * s.look_at} * T;
  } else if (s.motion.kind == PathKind::kDrive) {
    // Forwards along the floor, never closer than 0.4 m.
    const Vector3d ahead = Vector3d(T.R(0, 2), T.R(1, 2), 0).normalized();
    T.t += std::min(s.motion.speed_m_per_s * time_s, std::max(distance - 0.4, 0.0)) * ahead;
  }
  if (s.motion.shake_rad > 0) {
    Vector3d w;
    for (int axis = 0; axis < 3; ++axis) w[axis] = s.motion.shake_rad * Shake(s.motion.seed, axis, time_s);
    T.R = T.R * ExpSo3(w);
  }
  return T;
}

}  // namespace

StereoRig Scenario::RigAt(double time_s) const {
  constexpr double kStep = 1e-3;  // s
  StereoRig moved = rig;
  moved.T_world_left = PoseAt(*this, time_s);
  if (motion.kind == PathKind::kStill && motion.shake_rad == 0) return moved;
  const Pose before = PoseAt(*this, time_s - kStep), after = PoseAt(*this, time_s + kStep);
  moved.velocity = (after.t - before.t) / (2 * kStep);
  const Eigen::AngleAxisd turn(after.R * before.R.transpose());
  moved.rotation_rate = turn.angle() / (2 * kStep) * turn.axis();
  return moved;
}

Result<Scenario, std::string> MakeScenario(const ScenarioSpec& spec, std::uint64_t seed,
                                           const std::vector<TargetMesh>& targets) {
  if (const Result<void, std::string> known = CheckModels(spec, targets); !known) return unexpected(known.error());
  Draft best;
  double best_violation = 1e9;
  for (int i = 0; i < kMaxLayouts && best_violation > 0; ++i) {
    Draft draft = DrawScene(spec, Mix(seed, static_cast<std::uint64_t>(i)), targets);
    const double violation = Missing(spec, draft) + Violation(draft);
    if (violation >= best_violation) continue;
    best_violation = violation;
    best = std::move(draft);
  }
  return std::move(best.scenario);
}

}  // namespace wirepose::sim
