#include "sim/texture.h"

#include <algorithm>
#include <cmath>

#include "sim/noise.h"
#include "sim/print.h"

namespace wirepose::sim {
namespace {

// A place on the surface: metres from the lower corner of its face, and the face's extent.
struct PlanePoint {
  float u = 0, v = 0;
  float width = 0, height = 0;
  std::uint32_t face = 0;
};

PlanePoint MapToPlane(Mapping mapping, const Bounds& bounds, const Vector3& p, const Vector3& n) {
  if (mapping == Mapping::kCylinder && std::abs(n.z()) < 0.7F) {
    const Vector3 centre = 0.5F * (bounds.low + bounds.high);
    const float radius = 0.5F * (bounds.high.x() - bounds.low.x());
    const float angle = std::atan2(p.y() - centre.y(), p.x() - centre.x()) + 3.1415927F;
    return {angle * radius, p.z() - bounds.low.z(), 6.2831853F * radius, bounds.high.z() - bounds.low.z(), 6};
  }
  int axis = 0;
  n.cwiseAbs().maxCoeff(&axis);
  const int iu = axis == 0 ? 1 : 0, iv = axis == 2 ? 1 : 2;
  const std::uint32_t face = 2 * static_cast<std::uint32_t>(axis) + (n[axis] > 0 ? 1 : 0);
  return {p[iu] - bounds.low[iu], p[iv] - bounds.low[iv], bounds.high[iu] - bounds.low[iu],
          bounds.high[iv] - bounds.low[iv], face};
}

float Wood(const Material& m, const PlanePoint& q) {
  const int plank = Floor(q.v / m.scale_m);
  const float across = Fraction(q.v / m.scale_m) * m.scale_m;  // m into the plank
  constexpr float kJoint = 0.0015F;                            // m
  if (across < kJoint) return 0.4F * m.albedo;
  const float tone = 0.10F * (HashUnit(plank, 17, m.seed) - 0.5F);
  const std::uint32_t seed = m.seed + static_cast<std::uint32_t>(plank) * 7919U;
  const float bend = 0.02F * ValueNoise(q.u * 3.0F, q.v * 8.0F, seed);
  const float grain = ValueNoise(q.u * 2.5F, (q.v + bend) * 130.0F, seed);
  const float fibre = ValueNoise(q.u * 12.0F, q.v * 600.0F, seed + 1);
  return m.albedo * (1.0F + tone + 0.16F * grain + 0.06F * fibre);
}

float Stone(const Material& m, const PlanePoint& q) {
  const float s = 1.0F / m.scale_m;
  const float clouds = ValueNoise(q.u * s, q.v * s, m.seed);
  const float spots = ValueNoise(q.u * 4.3F * s, q.v * 4.3F * s, m.seed + 1);
  const float grains = ValueNoise(q.u * 13.7F * s, q.v * 13.7F * s, m.seed + 2);
  return m.albedo * (1.0F + 0.08F * clouds + 0.08F * spots + 0.12F * grains);
}

float Tiles(const Material& m, const PlanePoint& q, float joint_m, float variation) {
  const float fu = Fraction(q.u / m.scale_m) * m.scale_m;
  const float fv = Fraction(q.v / m.scale_m) * m.scale_m;
  if (fu < joint_m || fv < joint_m) return m.second_albedo;
  const float tone = HashUnit(Floor(q.u / m.scale_m), Floor(q.v / m.scale_m), m.seed) - 0.5F;
  return m.albedo * (1.0F + variation * tone);
}

float Checker(const Material& m, const PlanePoint& q) {
  const int parity = (Floor(q.u / m.scale_m) + Floor(q.v / m.scale_m)) & 1;
  return parity == 0 ? m.albedo : m.second_albedo;
}

// Rows of text-like blocks; (x, y) in metres, `row` the line height. True where there is ink.
bool Text(float x, float y, float row, std::uint32_t seed) {
  const int line = Floor(y / row);
  const float fy = Fraction(y / row);
  if (fy < 0.25F || fy > 0.80F) return false;
  const float letter = 0.55F * row;
  const int column = Floor(x / letter);
  if (HashUnit(column, line, seed) < 0.18F) return false;  // the gap between two words
  const float fx = Fraction(x / letter);
  if (fx > 0.8F) return false;
  const int cell = Floor(fx / 0.4F) + 2 * Floor((fy - 0.25F) / 0.1834F);
  return HashUnit(column * 8 + cell, line, seed + 3) < 0.65F;
}

bool Bars(float x, float module_m, std::uint32_t seed) { return HashUnit(Floor(x / module_m), 5, seed) < 0.5F; }

// An address label: light paper with text rows and a bar code.
float AddressLabel(const Material& m, float x, float y, float width, float height, std::uint32_t seed) {
  const float paper = std::min(0.92F, m.albedo + 0.4F), ink = 0.3F * m.albedo;
  const float margin = 0.06F * width;
  if (x < margin || y < margin || x > width - margin || y > height - margin) return paper;
  if (y < 0.3F * height) return Bars(x, 0.0025F, seed) ? ink : paper;
  if (y < 0.38F * height) return paper;
  return Text(x - margin, y, 0.013F, seed) ? ink : paper;
}

// One face of a printed carton, in one of four designs.
float Label(const Material& m, const PlanePoint& q) {
  const std::uint32_t seed = Hash(m.seed * 31U + q.face);
  const float x = q.u / q.width, y = q.v / q.height;  // 0..1
  switch (seed % 4) {
    case 0: {  // packing tape along the middle
      const bool tape = std::abs(y - 0.5F) * q.height < 0.024F;
      return tape ? Lerp(m.albedo, m.second_albedo, 0.45F) : m.albedo;
    }
    case 1: {  // a glued label
      const float x0 = 0.12F + 0.2F * HashUnit(1, 0, seed), y0 = 0.25F;
      if (x < x0 || x > x0 + 0.5F || y < y0 || y > y0 + 0.55F) return m.albedo;
      return AddressLabel(m, (x - x0) * q.width, (y - y0) * q.height, 0.5F * q.width, 0.55F * q.height, seed);
    }
    case 2: {  // a band with a title above it
      if (y > 0.12F && y < 0.32F) return m.second_albedo;
      const bool title = x > 0.1F && x < 0.9F && y > 0.5F && y < 0.85F;
      if (!title) return m.albedo;
      return Text((x - 0.1F) * q.width, (y - 0.5F) * q.height, 0.35F * q.height, seed) ? m.second_albedo : m.albedo;
    }
    default: {  // a picture: a disc on a ground that grows lighter
      const float dx = (x - 0.5F) * q.width, dy = (y - 0.55F) * q.height;
      const float radius = 0.28F * std::min(q.width, q.height);
      if (dx * dx + dy * dy < radius * radius) return m.second_albedo;
      return m.albedo * (0.85F + 0.3F * y);
    }
  }
}

float Marble(const Material& m, const PlanePoint& q) {
  const float x = q.u / m.scale_m, y = q.v / m.scale_m;
  const float warp = ValueNoise(x, y, m.seed) + 0.5F * ValueNoise(2.3F * x, 2.3F * y, m.seed + 1) +
                     0.25F * ValueNoise(5.1F * x, 5.1F * y, m.seed + 3);
  // Streaks along a slanted direction, warped; strong ones and faint ones.
  const float streak = std::abs(std::sin(0.9F * x + 1.7F * y + 2.2F * warp));
  const float strength = 0.5F + 0.5F * ValueNoise(0.6F * x, 0.6F * y, m.seed + 2);
  const float depth = std::max(0.0F, 1.0F - 5.0F * streak);
  return m.albedo * (1.0F + 0.06F * warp - 0.3F * strength * depth * depth);
}

float Steel(const Material& m, const PlanePoint& q) {
  return m.albedo * (1.0F + 0.06F * ValueNoise(q.u * 8.0F, q.v * 900.0F, m.seed));
}

// Print is upright and not mirrored for whoever looks at the face.
FacePoint ToFace(const Material& m, const PlanePoint& q) {
  const bool is_mirrored = q.face == 0 || q.face == 3 || q.face == 4;
  return {is_mirrored ? q.width - q.u : q.u, q.v, q.width, q.height, Hash(m.seed * 31U + q.face)};
}

float Book(const Material& m, const Bounds& bounds, const PlanePoint& q) {
  const Vector3 size = bounds.high - bounds.low;
  int thin = 0, middle = 0;
  size.minCoeff(&thin);
  for (int i = 0; i < 3; ++i) {
    if (i != thin && size[i] < size.maxCoeff()) middle = i;
  }
  const int axis = static_cast<int>(q.face / 2);
  const FacePoint face = ToFace(m, q);
  if (axis == thin) return BookCover(m, face);
  if (axis == middle && q.face % 2 == 0) return BookSpine(m, face);
  const int iu = axis == 0 ? 1 : 0;
  return BookPages(m, face, iu != thin);
}

float Fridge(const Material& m, const Bounds& bounds, const PlanePoint& q, const Vector3& p) {
  constexpr float kHandleDepth = 0.03F;  // m
  if (p.y() < bounds.low.y() + kHandleDepth) return m.second_albedo;
  return q.face == 2 ? DoorPrint(m, ToFace(m, q)) : m.albedo;
}

float Parts(const Material& m, const Bounds& bounds, const Vector3& p) {
  const float height = (p.z() - bounds.low.z()) / (bounds.high.z() - bounds.low.z());
  const bool is_dark_tank = (m.seed & 1U) != 0, is_dark_column = (m.seed & 2U) != 0;
  if (height < 0.1F) return (m.seed & 4U) != 0 ? m.second_albedo : m.albedo;
  if (height < 0.52F) return is_dark_column ? m.second_albedo : m.albedo;
  return is_dark_tank ? m.second_albedo : m.albedo;
}

float Pattern(const Material& m, const Bounds& bounds, const PlanePoint& q, const Vector3& p) {
  switch (m.texture) {
    case Texture::kPlain:
      return m.albedo;
    case Texture::kWood:
      return Wood(m, q);
    case Texture::kStone:
      return Stone(m, q);
    case Texture::kTiles:
      return Tiles(m, q, 0.004F, 0.14F);
    case Texture::kPanels:
      return Tiles(m, q, 0.006F, 0.0F);
    case Texture::kChecker:
      return Checker(m, q);
    case Texture::kLabel:
      return Label(m, q);
    case Texture::kMarble:
      return Marble(m, q);
    case Texture::kSteel:
      return Steel(m, q);
    case Texture::kParcel:
      return ParcelPrint(m, ToFace(m, q));
    case Texture::kGrocery:
      return GroceryPrint(m, ToFace(m, q));
    case Texture::kBook:
      return Book(m, bounds, q);
    case Texture::kPoster:
      return PosterPrint(m, ToFace(m, q));
    case Texture::kFridge:
      return Fridge(m, bounds, q, p);
    case Texture::kParts:
      return Parts(m, bounds, p);
  }
  return m.albedo;
}

}  // namespace

float AlbedoAt(const Material& material, const Bounds& bounds, const Vector3& p, const Vector3& n) {
  const PlanePoint q = MapToPlane(material.mapping, bounds, p, n);
  float albedo = Pattern(material, bounds, q, p);
  if (material.noise > 0) {
    // Mottling a few millimetres wide: enough for stereo to hold on to, too little to be an edge.
    albedo *= 1.0F + material.noise * ValueNoise(q.u * 250.0F, q.v * 250.0F, material.seed + 101U * q.face);
  }
  return std::clamp(albedo, 0.0F, 1.0F);
}

}  // namespace wirepose::sim
