#include "sim/texture.h"

#include <algorithm>
#include <cmath>

#include "sim/random.h"

namespace wirepose::sim {
namespace {

// A 32 bit integer hash (Wellons' lowbias32): cheap enough for several calls a sample.
std::uint32_t Hash(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7FEB352DU;
  x = (x ^ (x >> 15)) * 0x846CA68BU;
  return x ^ (x >> 16);
}

float HashUnit(int x, int y, std::uint32_t seed) {
  const std::uint32_t h =
      Hash(static_cast<std::uint32_t>(x) * 0x9E3779B1U ^ Hash(static_cast<std::uint32_t>(y) + seed * 0x85EBCA6BU));
  return static_cast<float>(h >> 8) * 0x1.0p-24F;
}

int Floor(float x) { return static_cast<int>(std::floor(x)); }
float Fraction(float x) { return x - std::floor(x); }
float Lerp(float a, float b, float t) { return a + (b - a) * t; }
float Smooth(float t) { return t * t * (3.0F - 2.0F * t); }

// Smooth noise in [-1, 1] with features one unit wide.
float ValueNoise(float x, float y, std::uint32_t seed) {
  const int ix = Floor(x), iy = Floor(y);
  const float tx = Smooth(x - static_cast<float>(ix)), ty = Smooth(y - static_cast<float>(iy));
  const float low = Lerp(HashUnit(ix, iy, seed), HashUnit(ix + 1, iy, seed), tx);
  const float high = Lerp(HashUnit(ix, iy + 1, seed), HashUnit(ix + 1, iy + 1, seed), tx);
  return 2.0F * Lerp(low, high, ty) - 1.0F;
}

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

float Pattern(const Material& m, const PlanePoint& q) {
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
  }
  return m.albedo;
}

}  // namespace

float AlbedoAt(const Material& material, const Bounds& bounds, const Vector3& p, const Vector3& n) {
  const PlanePoint q = MapToPlane(material.mapping, bounds, p, n);
  float albedo = Pattern(material, q);
  if (material.noise > 0) {
    // Mottling a few millimetres wide: enough for stereo to hold on to, too little to be an edge.
    albedo *= 1.0F + material.noise * ValueNoise(q.u * 250.0F, q.v * 250.0F, material.seed + 101U * q.face);
  }
  return std::clamp(albedo, 0.0F, 1.0F);
}

}  // namespace wirepose::sim
