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
  kMarble,   // veins
  kSteel,    // brushed along u
  kParcel,   // cardboard with tape, address labels, stamps
  kGrocery,  // brand name, picture, small print, bar code
  kBook,     // cover and back on the two largest faces, spine, pages
  kPoster,   // framed
  kFridge,   // a painted appliance, front = -y: notes on its doors, handles of `second_albedo`
  kParts,    // an appliance of two tones: base, column, tank
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
  // Share of the light that a view straight from above sees mirrored (0 matt, 0.04 varnish, 0.3
  // metal); more at grazing angles (Schlick 1994).
  float gloss = 0;
  float roughness = 0.2F;  // 0 a mirror .. 1
};

// Bounding box of the object, in its own frame: what a label is centred on.
struct Bounds {
  Vector3 low = Vector3::Zero(), high = Vector3::Zero();  // m
};

// Albedo in [0, 1] at point `p` [m] with unit normal `n`, both in the object's frame. Pure.
[[nodiscard]] float AlbedoAt(const Material& material, const Bounds& bounds, const Vector3& p, const Vector3& n);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_TEXTURE_H_
