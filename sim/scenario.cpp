#include "sim/scenario.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/placement.h"
#include "sim/random.h"

namespace wirepose::sim {
namespace {

constexpr double kMaxTargetSize = 0.6;      // m: larger things do not stand on a counter
constexpr double kCounterHalfDepth = 0.35;  // m
constexpr double kCounterHalfWidth = 1.6;   // m
constexpr double kGap = 0.012;              // m between things
constexpr double kWantedVisibility = 0.75;  // of each target, in the first frame
constexpr int kMaxLayouts = 40;
constexpr double kDegree = std::numbers::pi / 180;

float Pick(Random& random, double low, double high) { return static_cast<float>(random.Uniform(low, high)); }

std::uint32_t PickSeed(Random& random) { return static_cast<std::uint32_t>(random.Next()); }

// Adds meshes with poses to a scene.
class SceneBuilder {
 public:
  explicit SceneBuilder(Scene& scene) : scene_(scene) {}

  Instance& Add(const Mesh& mesh, const Pose& T_world_object, const Material& material) {
    scene_.meshes.push_back(mesh);
    Instance instance;
    instance.mesh = static_cast<int>(scene_.meshes.size()) - 1;
    instance.T_world_object = T_world_object;
    instance.material = material;
    scene_.instances.push_back(instance);
    return scene_.instances.back();
  }

  void AddSlab(const Vector3d& low, const Vector3d& high, const Material& material) {
    Pose T;
    T.t = 0.5 * (low + high);
    Add(MakeBox((high - low).cast<float>()), T, material);
  }

 private:
  Scene& scene_;
};

// Counter, wall, cabinets and floor. Returns the counter's albedo, for things to stand out from.
float BuildRoom(Random& random, SceneBuilder& builder) {
  Material counter;
  counter.texture = random.Chance(0.5) ? Texture::kWood : Texture::kStone;
  counter.scale_m = counter.texture == Texture::kWood ? 0.12F : 0.03F;
  counter.albedo = Pick(random, 0.35, 0.6);
  counter.seed = PickSeed(random);
  const double w = kCounterHalfWidth, d = kCounterHalfDepth;
  builder.AddSlab({-w, -d, -0.04}, {w, d, 0}, counter);

  Material wall{Texture::kTiles};
  wall.albedo = Pick(random, 0.45, 0.75);
  wall.second_albedo = wall.albedo * Pick(random, 0.5, 0.8);
  wall.scale_m = Pick(random, 0.09, 0.16);
  wall.noise = 0.03F;
  wall.seed = PickSeed(random);
  builder.AddSlab({-w, d, -1}, {w, d + 0.1, 1.6}, wall);

  Material cabinet{Texture::kPanels};
  cabinet.albedo = Pick(random, 0.25, 0.7);
  cabinet.second_albedo = 0.08F;
  cabinet.scale_m = 0.45F;
  cabinet.seed = PickSeed(random);
  builder.AddSlab({-w, -d + 0.03, -0.9}, {w, d, -0.041}, cabinet);

  Material floor{Texture::kTiles};
  floor.albedo = Pick(random, 0.2, 0.4);
  floor.second_albedo = 0.6F * floor.albedo;
  floor.scale_m = 0.3F;
  floor.seed = PickSeed(random);
  builder.AddSlab({-w, -3, -1}, {w, d, -0.9}, floor);
  return counter.albedo;
}

// A lamp above and a window to one side.
void AddLights(Random& random, Scene& scene) {
  AreaLight lamp;
  lamp.centre = Vector3(Pick(random, -0.4, 0.4), Pick(random, -0.5, -0.1), 1.8F);
  lamp.half_u = Vector3(0.25F, 0, 0);
  lamp.half_v = Vector3(0, -0.25F, 0);  // u x v points down
  lamp.intensity = Pick(random, 1.2, 2.2);
  AreaLight window;
  const float side = random.Chance(0.5) ? 1.0F : -1.0F;
  window.centre = Vector3(1.5F * side, Pick(random, -1.2, -0.6), Pick(random, 0.6, 1.0));
  window.half_u = Vector3(0, 0.35F * side, 0);
  window.half_v = Vector3(0, 0, -0.4F);  // u x v points to the counter
  window.intensity = Pick(random, 0.8, 2.0);
  scene.lights = {lamp, window};
  scene.ambient_up = 0.22F;
  scene.ambient_down = 0.12F;
  scene.background = 0.1F;
}

// An albedo that stands out from its surroundings by at least 0.15.
float StandOut(Random& random, float surroundings) {
  for (int i = 0; i < 50; ++i) {
    const float albedo = Pick(random, 0.2, 0.85);
    if (std::abs(albedo - surroundings) > 0.15F) return albedo;
  }
  return surroundings > 0.5F ? 0.2F : 0.8F;
}

// Fills the counter without letting things touch.
class Counter {
 public:
  Counter(Random& random, SceneBuilder& builder) : random_(random), builder_(builder) {}

  // The region in which something is put down.
  struct Region {
    double x_half, y_low, y_high;
  };

  // Puts the object somewhere in the region, turned by up to `max_yaw`; null when there was no
  // room.
  Instance* Place(const Mesh& mesh, const RestingPose& rest, const Region& region, double max_yaw,
                  const Material& material) {
    constexpr int kTries = 40;
    for (int i = 0; i < kTries; ++i) {
      Footprint print;
      print.centre = {random_.Uniform(-region.x_half, region.x_half), random_.Uniform(region.y_low, region.y_high)};
      print.half = rest.half;
      print.yaw_rad = random_.Uniform(-max_yaw, max_yaw);
      if (!IsFree(print)) continue;
      taken_.push_back(print);
      const Pose turn{Eigen::AngleAxisd(print.yaw_rad, Vector3d::UnitZ()).toRotationMatrix(),
                      Vector3d(print.centre.x(), print.centre.y(), 0)};
      return &builder_.Add(mesh, turn * rest.T_table_object, material);
    }
    return nullptr;
  }

 private:
  [[nodiscard]] bool IsFree(const Footprint& print) const {
    const double c = std::abs(std::cos(print.yaw_rad)), s = std::abs(std::sin(print.yaw_rad));
    const double reach = s * print.half.x() + c * print.half.y();
    if (std::abs(print.centre.y()) + reach > kCounterHalfDepth - kGap) return false;
    return std::none_of(taken_.begin(), taken_.end(),
                        [&](const Footprint& other) { return Overlap(print, other, kGap); });
  }

  Random& random_;
  SceneBuilder& builder_;
  std::vector<Footprint> taken_;
};

Material TargetMaterial(Random& random, const std::string& name, float counter_albedo) {
  Material material;
  material.texture = name.find("dispenser") == std::string::npos ? Texture::kLabel : Texture::kPlain;
  material.albedo = StandOut(random, counter_albedo);
  material.second_albedo = StandOut(random, material.albedo);
  material.seed = PickSeed(random);
  return material;
}

void PlaceTargets(Random& random, const std::vector<const TargetMesh*>& small, Counter& counter, float counter_albedo) {
  std::vector<const TargetMesh*> order = small;
  for (std::size_t i = order.size() - 1; i > 0; --i) {
    std::swap(order[i], order[static_cast<std::size_t>(random.Below(static_cast<int>(i) + 1))]);
  }
  const int count = 1 + random.Below(std::min<int>(3, static_cast<int>(order.size())));
  for (int i = 0; i < count; ++i) {
    const TargetMesh& target = *order[static_cast<std::size_t>(i)];
    const std::vector<RestingPose> rests = RestingPoses(target.mesh);
    const RestingPose& rest = rests[static_cast<std::size_t>(random.Below(static_cast<int>(rests.size())))];
    // Tall things stand behind low ones; what has a front shows it.
    const bool is_tall = rest.height > 0.35;
    const Counter::Region region = is_tall ? Counter::Region{0.22, 0.0, 0.15} : Counter::Region{0.32, -0.25, 0.1};
    const double max_yaw = rests.size() > 1 ? std::numbers::pi : 40 * kDegree;
    Instance* placed =
        counter.Place(target.mesh, rest, region, max_yaw, TargetMaterial(random, target.name, counter_albedo));
    if (placed == nullptr) continue;
    placed->obj_id = target.obj_id;
    placed->name = target.name;
  }
}

Mesh DistractorMesh(Random& random, Material& material) {
  material.seed = PickSeed(random);
  material.albedo = Pick(random, 0.15, 0.8);
  material.second_albedo = StandOut(random, material.albedo);
  switch (random.Below(4)) {
    case 0:
    case 1:
      material.texture = random.Chance(0.5) ? Texture::kLabel : Texture::kPlain;
      material.mapping = Mapping::kCylinder;
      return MakeCylinder(Pick(random, 0.03, 0.055), Pick(random, 0.08, 0.2), 48);
    case 2:
      material.texture = random.Chance(0.6) ? Texture::kLabel : Texture::kPlain;
      return MakeBox({Pick(random, 0.06, 0.12), Pick(random, 0.05, 0.1), Pick(random, 0.05, 0.22)});
    default:
      material.texture = Texture::kWood;
      material.scale_m = 0.07F;
      return MakeBox({Pick(random, 0.25, 0.35), Pick(random, 0.15, 0.22), 0.018F});
  }
}

void PlaceDistractors(Random& random, Counter& counter) {
  const int count = 3 + random.Below(4);
  for (int i = 0; i < count; ++i) {
    Material material;
    const Mesh mesh = DistractorMesh(random, material);
    (void)counter.Place(mesh, RestingPoses(mesh).front(), {0.6, -0.3, 0.3}, std::numbers::pi, material);
  }
}

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

void AimCamera(Random& random, Scenario& scenario) {
  Vector3d middle = Vector3d::Zero();
  double targets = 0, top = 0;
  for (const Instance& instance : scenario.scene.instances) {
    if (instance.obj_id == 0) continue;
    middle += instance.T_world_object.t;
    top = std::max(top, 2 * instance.T_world_object.t.z());
    targets += 1;
  }
  scenario.look_at = middle / std::max(targets, 1.0);
  scenario.look_at.x() += random.Uniform(-0.05, 0.05);
  scenario.look_at.z() *= 0.8;
  const double down = random.Uniform(15, 40) * kDegree;
  const double around = random.Uniform(-25, 25) * kDegree;
  const double distance = random.Uniform(top > 0.3 ? 0.95 : 0.7, 1.4);
  const Vector3d back(std::sin(around) * std::cos(down), -std::cos(around) * std::cos(down), std::sin(down));
  const double roll = random.Uniform(-2, 2) * kDegree;
  scenario.rig.T_world_left = LookAt(scenario.look_at + distance * back, scenario.look_at, roll);
}

Scenario TryLayout(std::uint64_t seed, const std::vector<const TargetMesh*>& small,
                   const StereoCalibration& calibration) {
  Random random(seed);
  Scenario scenario;
  SceneBuilder builder(scenario.scene);
  const float counter_albedo = BuildRoom(random, builder);
  AddLights(random, scenario.scene);
  Counter counter(random, builder);
  PlaceTargets(random, small, counter, counter_albedo);
  PlaceDistractors(random, counter);
  scenario.rig.calibration = calibration;
  AimCamera(random, scenario);
  return scenario;
}

// The least visible target's visible fraction, found at a quarter of the resolution.
double WorstVisibility(const Scenario& scenario) {
  Camera camera = LeftCamera(scenario.rig);
  camera.width /= 4;
  camera.height /= 4;
  camera.intrinsics.fx /= 4;
  camera.intrinsics.fy /= 4;
  camera.intrinsics.cx /= 4;
  camera.intrinsics.cy /= 4;
  double worst = 1;
  int targets = 0;
  for (const ObjectTruth& object : FindTruth(Renderer(scenario.scene), camera, 1).objects) {
    worst = std::min(worst, object.visib_fract);
    ++targets;
  }
  return targets > 0 ? worst : 0;
}

}  // namespace

StereoRig Scenario::RigAt(double time_s) const {
  constexpr double kSwing = 0.3, kBob = 0.05;  // rad
  const double around = kSwing * std::sin(orbit_rad_per_s / kSwing * time_s);
  const double up = kBob * std::sin(0.5 * time_s);
  // Turns about axes through `look_at`: the vertical one and the camera's own x axis.
  const Vector3d x = rig.T_world_left.R.col(0);
  const Matrix3d R = (Eigen::AngleAxisd(around, Vector3d::UnitZ()) * Eigen::AngleAxisd(up, x)).toRotationMatrix();
  StereoRig moved = rig;
  moved.T_world_left = Pose{R, look_at - R * look_at} * rig.T_world_left;
  return moved;
}

Result<Scenario, std::string> KitchenScenario(std::uint64_t seed, const std::vector<TargetMesh>& targets,
                                              const StereoCalibration& calibration) {
  std::vector<const TargetMesh*> small;
  for (const TargetMesh& target : targets) {
    const Vector3 size = target.mesh.Max() - target.mesh.Min();
    if (double{size.maxCoeff()} <= kMaxTargetSize) small.push_back(&target);
  }
  if (small.empty()) {
    return unexpected<std::string>(
        "kitchen scenario: no mesh is small enough for a counter (0.6 m); add one, and check that "
        "the meshes are in millimetres");
  }
  Scenario best;
  double best_visibility = -1;
  for (int i = 0; i < kMaxLayouts && best_visibility < kWantedVisibility; ++i) {
    Scenario scenario = TryLayout(Mix(seed, static_cast<std::uint64_t>(i)), small, calibration);
    const double visibility = WorstVisibility(scenario);
    if (visibility <= best_visibility) continue;
    best_visibility = visibility;
    best = std::move(scenario);
  }
  return best;
}

}  // namespace wirepose::sim
