#include "sim/furniture.h"

#include <algorithm>

namespace wirepose::sim {
namespace {

constexpr double kFrontThickness = 0.018, kFrontGap = 0.004;  // m
constexpr double kPlinth = 0.1, kBoard = 0.035;               // m

// One door or drawer front as a person before it sees it.
struct Front {
  double x0, x1, z0, z1;
  double y;  // of its outer face
};

enum class Grip : std::uint8_t { kTop, kLeft, kRight, kBottomLeft, kBottomRight };

void AddHandle(const KitchenStyle& style, const Front& f, Grip grip, SceneBuilder& builder) {
  const bool is_flat = grip == Grip::kTop;
  double x = 0.5 * (f.x0 + f.x1), z = f.z1 - std::min(0.06, 0.5 * (f.z1 - f.z0));
  if (!is_flat) {
    const bool is_left = grip == Grip::kLeft || grip == Grip::kBottomLeft;
    const bool is_low = grip == Grip::kBottomLeft || grip == Grip::kBottomRight;
    x = is_left ? f.x0 + 0.035 : f.x1 - 0.035;
    z = is_low ? f.z0 + 0.12 : f.z1 - 0.12;
  }
  if (!style.has_bar_handles) {
    Pose T;
    T.R = Eigen::AngleAxisd(0.5 * 3.14159265358979, Vector3d::UnitX()).toRotationMatrix();
    T.t = Vector3d(x, f.y - 0.014, z);
    builder.Add(MakeCylinder(0.014F, 0.028F, 24), T, style.handle);
    return;
  }
  const double length = is_flat ? std::min(0.14, 0.5 * (f.x1 - f.x0)) : std::min(0.14, 0.4 * (f.z1 - f.z0));
  const Vector3d half = is_flat ? Vector3d(length / 2, 0, 0.006) : Vector3d(0.006, 0, length / 2);
  const Vector3d centre(x, f.y - 0.028, z);
  builder.AddSlab(centre - half - Vector3d(0, 0.006, 0), centre + half + Vector3d(0, 0.006, 0), style.handle);
  const Vector3d foot = is_flat ? Vector3d(0.8 * length / 2, 0, 0) : Vector3d(0, 0, 0.8 * length / 2);
  for (const double side : {-1.0, 1.0}) {
    const Vector3d at = centre + side * foot;
    builder.AddSlab(at - Vector3d(0.005, 0, 0.005), at + Vector3d(0.005, 0.028, 0.005), style.handle);
  }
}

void AddFront(Random& random, const KitchenStyle& style, const Front& f, Grip grip, SceneBuilder& builder) {
  Material panel = style.front;
  panel.seed += DrawSeed(random) % 1000;
  builder.AddSlab({f.x0, f.y, f.z0}, {f.x1, f.y + kFrontThickness, f.z1}, panel);
  const double frame = 0.06, proud = 0.006;
  if (style.is_framed && f.z1 - f.z0 > 3 * frame && f.x1 - f.x0 > 3 * frame) {
    const double y0 = f.y - proud, y1 = f.y;
    builder.AddSlab({f.x0, y0, f.z0}, {f.x0 + frame, y1, f.z1}, panel);
    builder.AddSlab({f.x1 - frame, y0, f.z0}, {f.x1, y1, f.z1}, panel);
    builder.AddSlab({f.x0 + frame, y0, f.z0}, {f.x1 - frame, y1, f.z0 + frame}, panel);
    builder.AddSlab({f.x0 + frame, y0, f.z1 - frame}, {f.x1 - frame, y1, f.z1}, panel);
  }
  AddHandle(style, f, grip, builder);
}

void AddDrawers(Random& random, const KitchenStyle& style, const Front& whole, SceneBuilder& builder) {
  const int count = 2 + random.Below(3);
  const double height = (whole.z1 - whole.z0) / count;
  for (int i = 0; i < count; ++i) {
    Front f = whole;
    f.z0 = whole.z0 + i * height + kFrontGap / 2;
    f.z1 = whole.z0 + (i + 1) * height - kFrontGap / 2;
    AddFront(random, style, f, Grip::kTop, builder);
  }
}

void AddDoors(Random& random, const KitchenStyle& style, const Front& whole, bool is_low_grip, SceneBuilder& builder) {
  const double middle = 0.5 * (whole.x0 + whole.x1);
  const Grip left = is_low_grip ? Grip::kBottomLeft : Grip::kLeft,
             right = is_low_grip ? Grip::kBottomRight : Grip::kRight;
  if (whole.x1 - whole.x0 < 0.5) {
    AddFront(random, style, whole, random.Chance(0.5) ? left : right, builder);
    return;
  }
  Front f = whole;
  f.x1 = middle - kFrontGap / 2;
  AddFront(random, style, f, right, builder);
  f = whole;
  f.x0 = middle + kFrontGap / 2;
  AddFront(random, style, f, left, builder);
}

// Widths of the units that fill a row.
std::vector<double> Units(Random& random, double length) {
  std::vector<double> widths;
  double rest = length;
  while (rest > 0.95) {
    widths.push_back(random.Uniform(0.38, 0.85));
    rest -= widths.back();
  }
  widths.push_back(rest);
  return widths;
}

}  // namespace

void BuildBaseCabinets(Random& random, const KitchenStyle& style, const Row& row, SceneBuilder& builder) {
  const double front = row.wall_y - kRowDepth;  // of the carcass
  const double top = row.top_z - kBoard;
  builder.AddSlab({row.x0, front - 0.035, top}, {row.x1, row.wall_y, row.top_z}, style.worktop);
  builder.AddSlab({row.x0 + 0.002, front, row.floor_z + kPlinth}, {row.x1 - 0.002, row.wall_y, top}, style.carcass);
  Material plinth = style.carcass;
  plinth.albedo *= 0.5F;
  builder.AddSlab({row.x0 + 0.004, front + 0.05, row.floor_z}, {row.x1 - 0.004, row.wall_y, row.floor_z + kPlinth},
                  plinth);
  double x = row.x0;
  for (const double width : Units(random, row.x1 - row.x0)) {
    const Front whole{x + kFrontGap / 2, x + width - kFrontGap / 2, row.floor_z + kPlinth + kFrontGap, top - 0.012,
                      front - kFrontThickness};
    if (random.Chance(0.45)) {
      AddDrawers(random, style, whole, builder);
    } else {
      AddDoors(random, style, whole, false, builder);
    }
    x += width;
  }
}

void BuildWallCabinets(Random& random, const KitchenStyle& style, const Row& row, double low_z, double high_z,
                       SceneBuilder& builder) {
  constexpr double kDepth = 0.33;
  const double front = row.wall_y - kDepth;
  const double z0 = row.top_z + low_z, z1 = row.top_z + high_z;
  builder.AddSlab({row.x0 + 0.002, front, z0}, {row.x1 - 0.002, row.wall_y, z1}, style.carcass);
  double x = row.x0;
  for (const double width : Units(random, row.x1 - row.x0)) {
    AddDoors(random, style,
             {x + kFrontGap / 2, x + width - kFrontGap / 2, z0 + kFrontGap, z1 - kFrontGap, front - kFrontThickness},
             true, builder);
    x += width;
  }
}

void BuildTable(const Vector3d& half, double floor_z, const Material& top, const Material& legs,
                SceneBuilder& builder) {
  constexpr double kThickness = 0.035, kLeg = 0.06, kInset = 0.04, kApron = 0.08;
  const double hx = half.x(), hy = half.y();
  builder.AddSlab({-hx, -hy, -kThickness}, {hx, hy, 0}, top);
  const double lx = hx - kInset, ly = hy - kInset;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      const Vector3d a(sx * lx, sy * ly, floor_z), b(sx * (lx - kLeg), sy * (ly - kLeg), -kThickness);
      builder.AddSlab(a.cwiseMin(b), a.cwiseMax(b), legs);
    }
  }
  for (const double side : {-1.0, 1.0}) {
    const double y = side * (ly - kLeg / 2), x = side * (lx - kLeg / 2);
    builder.AddSlab({-lx + kLeg, y - 0.01, -kThickness - kApron}, {lx - kLeg, y + 0.01, -kThickness}, legs);
    builder.AddSlab({x - 0.01, -ly + kLeg, -kThickness - kApron}, {x + 0.01, ly - kLeg, -kThickness}, legs);
  }
}

void BuildChair(const Vector3d& at, double yaw_rad, const Material& material, SceneBuilder& builder) {
  constexpr double kHalf = 0.21, kSeat = 0.45, kBack = 0.92, kLeg = 0.035;
  const Pose T{Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()).toRotationMatrix(), at};
  const auto add = [&](const Vector3d& low, const Vector3d& high) {
    Pose part;
    part.t = 0.5 * (low + high);
    builder.Add(MakeBox((high - low).cast<float>()), T * part, material);
  };
  add({-kHalf, -kHalf, kSeat - 0.03}, {kHalf, kHalf, kSeat});
  for (const double sx : {-1.0, 1.0}) {
    const double x0 = sx > 0 ? kHalf - kLeg : -kHalf;
    add({x0, -kHalf, 0}, {x0 + kLeg, -kHalf + kLeg, kSeat - 0.03});
    add({x0, kHalf - kLeg, 0}, {x0 + kLeg, kHalf, kBack});
  }
  for (const double z : {0.58, 0.7, 0.82})
    add({-kHalf + kLeg, kHalf - 0.028, z}, {kHalf - kLeg, kHalf - 0.008, z + 0.055});
}

}  // namespace wirepose::sim
