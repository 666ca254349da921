#include "sim/room.h"

#include <algorithm>

#include "sim/furniture.h"

namespace wirepose::sim {
namespace {

constexpr double kCounterHeight = 0.9, kTableHeight = 0.74, kStorey = 2.5;  // m
constexpr double kWallReach = 3.2, kBehind = 4.0;                           // m from the origin

Material DrawSurface(Random& random, const std::vector<Texture>& textures, const Range& albedo, const Range& gloss) {
  Material m;
  m.texture = DrawOne(random, textures);
  m.albedo = DrawFloat(random, albedo);
  m.second_albedo = m.albedo * DrawFloat(random, {0.5, 0.8});
  m.gloss = DrawFloat(random, gloss);
  m.roughness = DrawFloat(random, {0.15, 0.5});
  m.noise = 0.03F;
  m.seed = DrawSeed(random);
  switch (m.texture) {
    case Texture::kWood:
      m.scale_m = DrawFloat(random, {0.08, 0.3});
      break;
    case Texture::kStone:
      m.scale_m = DrawFloat(random, {0.01, 0.05});
      break;
    case Texture::kMarble:
      m.scale_m = DrawFloat(random, {0.15, 0.4});
      break;
    default:
      m.scale_m = DrawFloat(random, {0.08, 0.25});
      break;
  }
  return m;
}

Material Plain(float albedo, float gloss = 0) {
  Material m;
  m.albedo = albedo;
  m.gloss = gloss;
  return m;
}

KitchenStyle DrawStyle(Random& random, const RoomSpec& spec) {
  KitchenStyle style;
  style.worktop = DrawSurface(random, spec.worktop, spec.worktop_albedo, spec.worktop_gloss);
  style.front = DrawSurface(random, spec.cabinet, spec.cabinet_albedo, {0, 0.03});
  style.carcass = Plain(0.35F * style.front.albedo);
  style.handle = random.Chance(0.6) ? Plain(DrawFloat(random, {0.03, 0.12})) : Plain(0.5F, 0.3F);
  style.is_framed = random.Chance(0.5);
  style.has_bar_handles = random.Chance(0.75);
  return style;
}

// Floor, ceiling and four walls; the back wall's face is at `wall_y`.
void BuildShell(Random& random, const RoomSpec& spec, const Room& room, SceneBuilder& builder) {
  const double x = kWallReach, z0 = room.floor_z, z1 = room.ceiling_z;
  Material wall = DrawSurface(random, spec.wall, spec.wall_albedo, {0, 0});
  if (wall.texture == Texture::kTiles) wall.texture = Texture::kPlain;  // tiles are at the worktop only
  Material tiles = DrawSurface(random, {Texture::kTiles, Texture::kWood, Texture::kStone}, {0.15, 0.7}, {0, 0.04});
  tiles.scale_m = DrawFloat(random, {0.2, 0.5});
  builder.AddSlab({-x, room.wall_y, z0}, {x, room.wall_y + 0.1, z1}, wall);
  builder.AddSlab({-x, -kBehind, z0 - 0.1}, {x, room.wall_y + 0.1, z0}, tiles);
  builder.AddSlab({-x, -kBehind, z1}, {x, room.wall_y + 0.1, z1 + 0.1}, Plain(0.8F));
  const Material side = Plain(wall.albedo);
  builder.AddSlab({-x - 0.1, -kBehind, z0}, {-x, room.wall_y, z1}, side);
  builder.AddSlab({x, -kBehind, z0}, {x + 0.1, room.wall_y, z1}, side);
  builder.AddSlab({-x, -kBehind - 0.1, z0}, {x, -kBehind, z1}, side);
}

void HangPosters(Random& random, const Room& room, double x0, double x1, double low_z, SceneBuilder& builder) {
  const int count = random.Below(3);
  double x = x0 + random.Uniform(0.05, 0.4);
  for (int i = 0; i < count && x < x1 - 0.3; ++i) {
    const double w = random.Uniform(0.2, 0.5), h = w * random.Uniform(1, 1.5);
    const double z = low_z + random.Uniform(0, 0.5);
    Material m = DrawSurface(random, {Texture::kPoster}, {0.5, 0.85}, {0, 0.05});
    m.second_albedo = DrawFloat(random, {0.04, 0.6});
    builder.AddSlab({x, room.wall_y - 0.015, z}, {x + w, room.wall_y, z + h}, m);
    x += w + random.Uniform(0.1, 0.6);
  }
}

// What is above a worktop: tiles, then cabinets or a shelf or the bare wall.
void BuildAbove(Random& random, const RoomSpec& spec, const KitchenStyle& style, const Row& row, Room& room,
                SceneBuilder& builder) {
  if (std::find(spec.wall.begin(), spec.wall.end(), Texture::kTiles) != spec.wall.end() && random.Chance(0.8)) {
    Material tiles = DrawSurface(random, {Texture::kTiles}, spec.wall_albedo, {0, 0.06});
    tiles.scale_m = DrawFloat(random, {0.07, 0.2});
    builder.AddSlab({row.x0, room.wall_y - 0.008, row.top_z}, {row.x1, room.wall_y - 0.0005, row.top_z + 0.6}, tiles);
  }
  const double kind = random.Uniform(0, 1);
  const double low = random.Uniform(0.48, 0.6);
  if (kind < 0.6) {
    room.has_wall_cabinets = true;
    BuildWallCabinets(random, style, row, low, low + random.Uniform(0.55, 0.75), builder);
  } else if (kind < 0.8) {
    const double z = row.top_z + low;
    builder.AddSlab({row.x0 + 0.1, room.wall_y - 0.24, z - 0.025}, {row.x1 - 0.1, room.wall_y - 0.01, z},
                    style.worktop);
    room.boards.push_back(
        {{0.5 * (row.x0 + row.x1), room.wall_y - 0.13}, {0.5 * (row.x1 - row.x0) - 0.12, 0.09}, z, 0.5F});
  } else {
    HangPosters(random, room, row.x0, row.x1, row.top_z + 0.65, builder);
  }
}

Room BuildCounter(Random& random, const RoomSpec& spec, bool needs_bay, SceneBuilder& builder) {
  Room room;
  room.wall_y = kRowDepth / 2;
  room.floor_z = -kCounterHeight;
  room.ceiling_z = kStorey - kCounterHeight;
  const KitchenStyle style = DrawStyle(random, spec);
  const bool is_bay_right = random.Chance(0.5);
  Row row{-1.5, 1.5, room.wall_y, 0, room.floor_z};
  // The bay: from 0.5 m beside the middle, so that worktop and refrigerator are in one view.
  if (needs_bay) (is_bay_right ? row.x1 : row.x0) = is_bay_right ? 0.55 : -0.55;
  BuildShell(random, spec, room, builder);
  BuildBaseCabinets(random, style, row, builder);
  BuildAbove(random, spec, style, row, room, builder);
  const double bay = is_bay_right ? row.x1 : row.x0, side = is_bay_right ? 1 : -1;
  room.floor = {{bay + side * 0.4, room.wall_y - 0.42}, {0.38, 0.4}, room.floor_z, 0.4F};
  HangPosters(random, room, is_bay_right ? row.x1 + 0.9 : -kWallReach, is_bay_right ? kWallReach : row.x0 - 0.9, 0.2,
              builder);
  room.worktop = {{0.5 * (row.x0 + row.x1), 0}, {0.5 * (row.x1 - row.x0) - 0.05, 0.3}, 0, style.worktop.albedo};
  return room;
}

Room BuildTableRoom(Random& random, const RoomSpec& spec, SceneBuilder& builder) {
  Room room;
  room.wall_y = random.Uniform(1.0, 2.2);
  room.floor_z = -kTableHeight;
  room.ceiling_z = kStorey - kTableHeight;
  const KitchenStyle style = DrawStyle(random, spec);
  BuildShell(random, spec, room, builder);
  if (random.Chance(0.7)) {
    const double x0 = random.Uniform(-2.8, -0.5);
    const Row row{x0, x0 + random.Uniform(1.5, 3), room.wall_y, kCounterHeight - kTableHeight, room.floor_z};
    BuildBaseCabinets(random, style, row, builder);
    BuildAbove(random, spec, style, row, room, builder);
    room.boards.push_back(
        {{0.5 * (row.x0 + row.x1), room.wall_y - 0.3}, {0.5 * (row.x1 - row.x0) - 0.1, 0.22}, row.top_z, 0.5F});
  } else {
    HangPosters(random, room, -2, 2, 0.3, builder);
  }
  const Material top = DrawSurface(random, spec.worktop, spec.worktop_albedo, spec.worktop_gloss);
  const Material legs = random.Chance(0.5) ? top : Plain(DrawFloat(random, {0.04, 0.6}));
  const Vector3d half(random.Uniform(0.55, 0.8), random.Uniform(0.36, 0.45), 0);
  BuildTable(half, room.floor_z, top, legs, builder);
  const int chairs = random.Below(3);
  const Material wood =
      random.Chance(0.5) ? legs : DrawSurface(random, {Texture::kWood, Texture::kPlain}, {0.05, 0.6}, {0, 0.03});
  for (int i = 0; i < chairs; ++i) {
    const double x = (i == 0 ? -0.5 : 0.5) * half.x();
    BuildChair({x + random.Uniform(-0.1, 0.1), half.y() + random.Uniform(0.0, 0.25), room.floor_z},
               random.Uniform(-0.3, 0.3), wood, builder);
  }
  room.worktop = {{0, 0}, {half.x() - 0.03, half.y() - 0.03}, 0, top.albedo};
  room.floor = {{random.Chance(0.5) ? -1.8 : 1.8, room.wall_y - 0.45}, {0.38, 0.4}, room.floor_z, 0.4F};
  return room;
}

Room BuildShelfRoom(Random& random, const RoomSpec& spec, SceneBuilder& builder) {
  Room room;
  room.wall_y = 0.2;
  room.floor_z = -random.Uniform(0.8, 1.2);
  room.ceiling_z = room.floor_z + kStorey;
  BuildShell(random, spec, room, builder);
  const Material wood = DrawSurface(random, spec.worktop, spec.worktop_albedo, spec.worktop_gloss);
  const double w = random.Uniform(0.42, 0.6), d = 0.19, gap = random.Uniform(0.36, 0.42), board = 0.022;
  const double low = -gap * 2, high = gap * 2;
  builder.AddSlab({-w - board, -d, low}, {-w, d, high}, wood);
  builder.AddSlab({w, -d, low}, {w + board, d, high}, wood);
  builder.AddSlab({-w, d - 0.01, low}, {w, d, high}, wood);
  for (int i = -2; i <= 2; ++i) {
    builder.AddSlab({-w, -d, i * gap - board}, {w, d - 0.01, i * gap}, wood);
    if (i != 0 && i < 2) room.boards.push_back({{0, -0.01}, {w - 0.02, d - 0.03}, i * gap, wood.albedo});
  }
  HangPosters(random, room, w + 0.2, w + 1.5, -0.2, builder);
  HangPosters(random, room, -w - 1.5, -w - 0.4, -0.2, builder);
  room.worktop = {{0, -0.01}, {w - 0.02, d - 0.03}, 0, wood.albedo};
  room.floor = {{w + 0.6, room.wall_y - 0.45}, {0.38, 0.4}, room.floor_z, 0.4F};
  return room;
}

// An empty corner of a laboratory: a plain bench before a plain wall.
Room BuildStudio(Random& random, const RoomSpec& spec, SceneBuilder& builder) {
  Room room;
  room.wall_y = 0.8;
  const Material bench = DrawSurface(random, spec.worktop, spec.worktop_albedo, spec.worktop_gloss);
  BuildShell(random, spec, room, builder);
  builder.AddSlab({-1.5, -0.7, -0.05}, {1.5, 0.6, 0}, bench);
  room.worktop = {{0, 0}, {1.2, 0.55}, 0, bench.albedo};
  room.floor = {{2, 0.3}, {0.38, 0.4}, room.floor_z, 0.4F};
  return room;
}

}  // namespace

Room BuildRoom(Random& random, const RoomSpec& spec, bool needs_bay, SceneBuilder& builder) {
  switch (spec.kind) {
    case RoomKind::kCounter:
      return BuildCounter(random, spec, needs_bay, builder);
    case RoomKind::kTable:
      return BuildTableRoom(random, spec, builder);
    case RoomKind::kShelf:
      return BuildShelfRoom(random, spec, builder);
    case RoomKind::kStudio:
      break;
  }
  return BuildStudio(random, spec, builder);
}

}  // namespace wirepose::sim
