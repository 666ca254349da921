// Light styles of a room.
#include "sim/room.h"

#include <vector>

namespace wirepose::sim {
namespace {

// A lamp that shines downwards.
AreaLight Above(const Vector3& centre, float half_x, float half_y, float intensity) {
  return {centre, Vector3(half_x, 0, 0), Vector3(0, -half_y, 0), intensity};
}

AreaLight Ceiling(Random& random, const Room& room, float intensity) {
  const float half = DrawFloat(random, {0.15, 0.35});
  const Vector3 centre(DrawFloat(random, {-0.7, 0.7}), DrawFloat(random, {-1.6, -0.5}),
                       static_cast<float>(room.ceiling_z) - 0.02F);
  return Above(centre, half, half, intensity);
}

AreaLight Window(Random& random, const Room& room, float intensity) {
  const float side = random.Chance(0.5) ? 1.0F : -1.0F;
  const auto z = static_cast<float>(0.5 * (room.floor_z + room.ceiling_z)) + 0.3F;
  // u x v points into the room.
  return {Vector3(3.15F * side, DrawFloat(random, {-2, -0.4}), z), Vector3(0, 0.5F * side, 0), Vector3(0, 0, -0.6F),
          intensity};
}

// A small lamp close by: hard shadows.
AreaLight Lamp(Random& random) {
  const float x = DrawFloat(random, {0.5, 1.3}) * (random.Chance(0.5) ? 1.0F : -1.0F);
  return Above({x, DrawFloat(random, {-1.2, -0.3}), DrawFloat(random, {0.8, 1.4})}, 0.04F, 0.04F, 2.5F);
}

// The whole ceiling shines. In pieces: the renderer chooses among lights by their middles, which
// serves lights that are short against their distance.
std::vector<AreaLight> Overcast(const Room& room, float intensity) {
  std::vector<AreaLight> pieces;
  for (const float x : {-1.4F, 0.0F, 1.4F}) {
    for (const float y : {-2.4F, -0.9F}) {
      pieces.push_back(Above({x, y, static_cast<float>(room.ceiling_z) - 0.02F}, 0.7F, 0.75F, intensity / 6));
    }
  }
  return pieces;
}

// A strip below the wall cabinets, in pieces for the same reason.
std::vector<AreaLight> UnderCabinet(const Room& room, float intensity) {
  constexpr int kPieces = 6;
  constexpr float kHalf = 0.1F;  // m
  const auto middle = static_cast<float>(room.worktop.centre.x()), y = static_cast<float>(room.wall_y) - 0.25F;
  std::vector<AreaLight> pieces;
  for (int i = 0; i < kPieces; ++i) {
    const float x = middle + kHalf * static_cast<float>(2 * i + 1 - kPieces);
    pieces.push_back(Above({x, y, 0.45F}, kHalf, 0.015F, intensity / kPieces));
  }
  return pieces;
}

}  // namespace

void AddLights(Random& random, const LightSpec& spec, const Room& room, Scene& scene) {
  const auto ambient = [&](float up, float down) {
    const float factor = DrawFloat(random, spec.ambient);
    scene.ambient_up = factor * up;
    scene.ambient_down = factor * down;
  };
  switch (DrawOne(random, spec.styles)) {
    case LightStyle::kCeiling:
      scene.lights = {Ceiling(random, room, 4), Ceiling(random, room, 3)};
      ambient(0.35F, 0.3F);
      break;
    case LightStyle::kWindow:
      scene.lights = {Window(random, room, 10), Ceiling(random, room, 0.6F)};
      ambient(0.25F, 0.2F);
      break;
    case LightStyle::kLamp:
      scene.lights = {Lamp(random)};
      ambient(0.16F, 0.12F);
      break;
    case LightStyle::kFlat:
      scene.lights = Overcast(room, 2);
      ambient(0.5F, 0.45F);
      break;
    case LightStyle::kUnderCabinet:
      scene.lights = UnderCabinet(room, 0.3F);
      scene.lights.push_back(Ceiling(random, room, 1.8F));
      ambient(0.25F, 0.2F);
      break;
    case LightStyle::kMixed:
      scene.lights = {Ceiling(random, room, 2), Window(random, room, 5), Lamp(random)};
      scene.lights.back().intensity = 0.6F;
      ambient(0.3F, 0.25F);
      break;
  }
  scene.background = 0.2F;
}

}  // namespace wirepose::sim
