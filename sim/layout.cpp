#include "sim/layout.h"

#include <algorithm>
#include <cmath>

namespace wirepose::sim {
namespace {

constexpr double kGap = 0.012;  // m between things
constexpr int kTries = 40;
constexpr double kMaxOnTable = 0.6;  // m: larger things do not stand on a worktop

Mesh Scaled(const Mesh& mesh, float scale) {
  Mesh scaled = mesh;
  for (Vector3& v : scaled.vertices) v *= scale;
  return scaled;
}

bool Fits(const ObjectSpec& spec, const TargetMesh& target) {
  if (!spec.models.empty()) return std::find(spec.models.begin(), spec.models.end(), target.name) != spec.models.end();
  return FitsOn(spec.on, target);
}

bool IsBookLike(const Mesh& mesh) {
  const Vector3 size = mesh.Max() - mesh.Min();
  return size.minCoeff() < 0.3F * size.maxCoeff();
}

Matrix3d Turn(double degrees, const Vector3d& axis) {
  return Eigen::AngleAxisd(degrees * kDegree, axis).toRotationMatrix();
}

double HeightOf(const Mesh& mesh, const Pose& T) {
  double top = -1e9;
  for (const Vector3& v : mesh.vertices) top = std::max(top, (T * v.cast<double>()).z());
  return top;
}

}  // namespace

bool FitsOn(Support support, const TargetMesh& target) {
  return support == Support::kFloor || double{(target.mesh.Max() - target.mesh.Min()).maxCoeff()} <= kMaxOnTable;
}

void Layout::PlaceObjects(const std::vector<ObjectSpec>& specs, const std::vector<TargetMesh>& targets) {
  for (const ObjectSpec& spec : specs) {
    std::vector<const TargetMesh*> fitting;
    for (const TargetMesh& target : targets) {
      if (Fits(spec, target)) fitting.push_back(&target);
    }
    if (fitting.empty()) continue;
    const int count = DrawCount(random_, spec.count);
    for (int i = 0; i < count; ++i) PlaceObject(spec, *DrawOne(random_, fitting));
  }
}

void Layout::PlaceObject(const ObjectSpec& spec, const TargetMesh& target) {
  const Place* support = SupportOf(spec);
  if (support == nullptr) return;
  const Mesh mesh = Scaled(target.mesh, DrawFloat(random_, spec.scale));
  const Material material = DrawMaterial(spec, target.name, mesh, support->albedo);
  Scene& scene = builder_.scene();
  if (spec.pose) {
    builder_.Add(mesh, DrawPose(*spec.pose), material);
  } else {
    const bool is_cuboid = RestingPoses(mesh).size() > 1;
    Region region{spec.x_m, spec.y_m, support->z, support};
    if (spec.on != Support::kWorktop) {
      const Eigen::Vector2d c = support->centre;
      region.x = {c.x() - 0.04, c.x() + 0.04};
      region.y = {c.y() - 0.03, c.y() + 0.03};
    }
    // What has a front shows it; what stands on the floor stands along the wall.
    const double most = spec.on == Support::kFloor ? 8 : is_cuboid ? 360 : 55;
    const Range yaw{std::max(spec.yaw_deg.low, -most), std::min(spec.yaw_deg.high, most)};
    if (!PutDown(mesh, DrawRest(mesh, spec.rest, is_cuboid), region, yaw, material)) return;
  }
  Instance& instance = scene.instances.back();
  const int index = static_cast<int>(scene.instances.size()) - 1;
  if (target.name == "refrigerator") {
    const double top = HeightOf(mesh, instance.T_world_object);
    refrigerator_top_ = {instance.T_world_object.t.head<2>(), {0.27, 0.28}, top, material.albedo};
  }
  if (spec.is_look_alike) return;
  instance.obj_id = target.obj_id;
  instance.name = target.name;
  placed_.push_back({index, &spec});
}

Pose Layout::DrawPose(const PoseSpec& spec) {
  Pose T;
  for (int i = 0; i < 3; ++i) T.t[i] = Draw(random_, spec.position_m[static_cast<std::size_t>(i)]);
  T.R = Turn(Draw(random_, spec.rotation_deg[2]), Vector3d::UnitZ()) *
        Turn(Draw(random_, spec.rotation_deg[1]), Vector3d::UnitY()) *
        Turn(Draw(random_, spec.rotation_deg[0]), Vector3d::UnitX());
  return T;
}

const Place* Layout::SupportOf(const ObjectSpec& spec) {
  switch (spec.on) {
    case Support::kWorktop:
      return &room_.worktop;
    case Support::kFloor:
      return &room_.floor;
    case Support::kOnRefrigerator:
      break;
  }
  return refrigerator_top_.half.x() > 0 ? &refrigerator_top_ : nullptr;
}

RestingPose Layout::DrawRest(const Mesh& mesh, Rest rest, bool is_cuboid) {
  std::vector<RestingPose> poses = RestingPoses(mesh);
  if (!is_cuboid || rest == Rest::kUpright) return poses.front();
  if (rest == Rest::kFlat) {
    return *std::min_element(poses.begin(), poses.end(),
                             [](const auto& a, const auto& b) { return a.height < b.height; });
  }
  return DrawOne(random_, poses);
}

Material Layout::DrawMaterial(const ObjectSpec& spec, const std::string& name, const Mesh& mesh, float ground) {
  Material m;
  m.seed = DrawSeed(random_);
  m.gloss = DrawFloat(random_, spec.gloss);
  m.roughness = DrawFloat(random_, {0.15, 0.5});
  if (spec.albedo) {
    m.albedo = DrawFloat(random_, *spec.albedo);
  } else if (spec.contrast) {
    const float step = DrawFloat(random_, *spec.contrast);
    m.albedo = std::clamp(random_.Chance(0.5) ? ground + step : ground - step, 0.03F, 0.9F);
  } else {
    m.albedo = random_.Chance(0.2) ? std::clamp(ground + DrawFloat(random_, {-0.12, 0.12}), 0.05F, 0.85F)
                                   : StandOut(random_, ground);
  }
  m.second_albedo = StandOut(random_, m.albedo);
  const bool is_printed = spec.print == Print::kPrinted || (spec.print == Print::kAny && random_.Chance(0.85));
  if (name == "refrigerator") {
    m.texture = Texture::kFridge;
    if (!is_printed) m.second_albedo = 0.7F * m.albedo;
  } else if (name.find("dispenser") != std::string::npos) {
    m.texture = is_printed ? Texture::kParts : Texture::kPlain;
  } else if (is_printed) {
    m.texture = IsBookLike(mesh) ? Texture::kBook : random_.Chance(0.6) ? Texture::kParcel : Texture::kGrocery;
  }
  return m;
}

bool Layout::PutDown(const Mesh& mesh, const RestingPose& rest, const Region& region, const Range& yaw_deg,
                     const Material& material) {
  for (int i = 0; i < kTries; ++i) {
    Footprint print;
    print.centre = {Draw(random_, region.x), Draw(random_, region.y)};
    print.half = rest.half;
    print.yaw_rad = Draw(random_, yaw_deg) * kDegree;
    if (!IsFree(print, region)) continue;
    standing_.push_back({print, region.z});
    const Pose turn{Eigen::AngleAxisd(print.yaw_rad, Vector3d::UnitZ()).toRotationMatrix(),
                    Vector3d(print.centre.x(), print.centre.y(), region.z)};
    builder_.Add(mesh, turn * rest.T_table_object, material);
    return true;
  }
  return false;
}

bool Layout::IsFree(const Footprint& print, const Region& region) const {
  const double c = std::abs(std::cos(print.yaw_rad)), s = std::abs(std::sin(print.yaw_rad));
  const Eigen::Vector2d reach(c * print.half.x() + s * print.half.y(), s * print.half.x() + c * print.half.y());
  const Eigen::Vector2d off = (print.centre - region.within->centre).cwiseAbs() + reach;
  if ((off.array() > region.within->half.array()).any()) return false;
  return std::none_of(standing_.begin(), standing_.end(),
                      [&](const Standing& other) { return other.z == region.z && Overlap(print, other.print, kGap); });
}

void Layout::PlaceClutter(const ClutterSpec& spec) {
  const auto put = [&](const Place& on, const Range& x) {
    const Thing thing = DrawThing(random_);
    const Region region{x, {on.centre.y() - on.half.y(), on.centre.y() + on.half.y()}, on.z, &on};
    (void)PutDown(thing.mesh, DrawRest(thing.mesh, Rest::kAny, thing.is_cuboid), region, {-180, 180}, thing.material);
  };
  const int count = DrawCount(random_, spec.count);
  const double reach = Draw(random_, spec.reach_m);
  for (int i = 0; i < count; ++i) put(room_.worktop, {-reach, reach});
  if (count == 0) return;
  for (const Place& board : room_.boards) {
    const int things = 1 + random_.Below(5);
    for (int i = 0; i < things; ++i) put(board, {board.centre.x() - board.half.x(), board.centre.x() + board.half.x()});
  }
}

void Layout::PlaceOccluders(const ClutterSpec& spec, const Vector3d& eye) {
  if (placed_.empty()) return;
  const int count = DrawCount(random_, spec.occluders);
  const Vector3d object =
      builder_.scene().instances[static_cast<std::size_t>(placed_.front().instance)].T_world_object.t;
  const Eigen::Vector2d towards = (eye - object).head<2>().normalized(), across(-towards.y(), towards.x());
  for (int i = 0; i < count; ++i) {
    const Thing thing = DrawOccluder(random_);
    const Eigen::Vector2d at =
        object.head<2>() + random_.Uniform(0.08, 0.35) * towards + random_.Uniform(-0.2, 0.2) * across;
    const Region region{
        {at.x() - 0.03, at.x() + 0.03}, {at.y() - 0.03, at.y() + 0.03}, room_.worktop.z, &room_.worktop};
    (void)PutDown(thing.mesh, RestingPoses(thing.mesh).front(), region, {-180, 180}, thing.material);
  }
}

}  // namespace wirepose::sim
