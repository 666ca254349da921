// What surfaces look like: grey albedo as a function of the place on the object. All patterns are
// computed, none is stored, so they are sharp at any distance; the renderer's samples smooth them.
#ifndef WIREPOSE_SIM_TEXTURE_H_
#define WIREPOSE_SIM_TEXTURE_H_

#include <cstdint>

#include "geometry/se3.h"

namespace wirepose::sim {

enum class Texture : std::uint8_t {
  kPlain,    // one albedo
  kWood,     // grain along u, planks of `scale_m` with dark joints
  kStone,    // speckles of several sizes, from `scale_m` down
  kTiles,    // tiles of `scale_m` that differ a little, with joints of `second_albedo`
  kPanels,   // as kTiles but wide joints only: cabinet doors
  kChecker,  // squares of `scale_m`, `albedo` and `second_albedo`
  kLabel,    // a printed carton: tape, labels with text and bars, bands; every face of its own
};

// How a point of the surface gets its plane coordinates (u, v).
enum class Mapping : std::uint8_t {
  kBox,       // along the axis that the normal is closest to
  kCylinder,  // around z; ends as kBox
};

struct Material {
  Texture texture = Texture::kPlain;
  Mapping mapping = Mapping::kBox;
  float albedo = 0.5F;  // 0 black .. 1 white
  float second_albedo = 0.2F;
  float scale_m = 0.1F;
  float noise = 0.02F;     // amplitude of the fine mottling on top of every texture
  std::uint32_t seed = 0;  // tells two instances of one texture apart
};

// Bounding box of the object, in its own frame: what a label is centred on.
struct Bounds {
  Vector3 low = Vector3::Zero(), high = Vector3::Zero();  // m
};

// Albedo in [0, 1] at point `p` [m] with unit normal `n`, both in the object's frame. Pure.
[[nodiscard]] float AlbedoAt(const Material& material, const Bounds& bounds, const Vector3& p, const Vector3& n);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_TEXTURE_H_
