#include "sim/print.h"

#include <algorithm>
#include <cmath>

#include "sim/glyphs.h"
#include "sim/noise.h"

namespace wirepose::sim {
namespace {

constexpr float kPaper = 0.82F, kInk = 0.05F;

// A rectangle on the face, metres.
struct Area {
  float x = 0, y = 0, width = 0, height = 0;

  [[nodiscard]] bool Has(float px, float py) const { return px >= x && py >= y && px < x + width && py < y + height; }
};

// A number in [low, high) that belongs to the face and the purpose `key`.
float Pick(const FacePoint& f, int key, float low, float high) { return Lerp(low, high, HashUnit(key, 11, f.seed)); }

// A grey that differs from `other` by a third at least.
float Contrast(const FacePoint& f, int key, float other) {
  const float ink = Pick(f, key, 0.04F, 0.85F);
  if (std::abs(ink - other) > 0.25F) return ink;
  return other > 0.4F ? 0.4F * other : std::min(0.9F, other + 0.4F);
}

bool BarCode(const Area& a, float x, float y, std::uint32_t seed) {
  return a.Has(x, y) && HashUnit(Floor((x - a.x) / (a.width / 60)), 5, seed) < 0.5F;
}

// Discs, wedges and a horizon in a frame: at a distance, a photograph.
float Picture(const Area& a, float x, float y, const FacePoint& f, float ground) {
  const float u = (x - a.x) / a.height, v = (y - a.y) / a.height;
  const float sky = Contrast(f, 40, ground);
  float tone = sky * (0.75F + 0.5F * v);
  const float horizon = Pick(f, 41, 0.2F, 0.5F) + 0.06F * ValueNoise(3 * u, 0, f.seed);
  if (v < horizon) tone = Pick(f, 42, 0.08F, 0.6F) * (1 + 0.2F * ValueNoise(20 * u, 20 * v, f.seed + 1));
  const int shapes = 2 + static_cast<int>(Pick(f, 43, 0, 4));
  for (int i = 0; i < shapes; ++i) {
    const float cx = Pick(f, 50 + i, 0.15F, 0.85F) * a.width / a.height, cy = Pick(f, 60 + i, 0.2F, 0.8F);
    const float size = Pick(f, 70 + i, 0.08F, 0.28F), turn = Pick(f, 80 + i, 0, 6.3F);
    const float dx = u - cx, dy = v - cy;
    const float rx = std::cos(turn) * dx + std::sin(turn) * dy, ry = std::cos(turn) * dy - std::sin(turn) * dx;
    const bool is_disc = HashUnit(i, 12, f.seed) < 0.5F;
    const bool is_in =
        is_disc ? rx * rx + 2 * ry * ry < size * size : std::abs(rx) < size && std::abs(ry) < 0.6F * size - 0.4F * rx;
    if (is_in) tone = Pick(f, 90 + i, 0.05F, 0.85F) * (1 + 0.25F * rx / size);
  }
  return tone;
}

// A white label: sender, address, bar code.
float AddressLabel(const Area& a, float x, float y, const FacePoint& f) {
  const float u = x - a.x, v = y - a.y;
  const float rule = 0.0008F;
  if (v < 0.34F * a.height) {
    const Area bars{a.x + 0.1F * a.width, a.y + 0.08F * a.height, 0.8F * a.width, 0.22F * a.height};
    return BarCode(bars, x, y, f.seed) ? kInk : kPaper;
  }
  if (v < 0.34F * a.height + rule || std::abs(v - 0.72F * a.height) < rule) return kInk;
  const float margin = 0.06F * a.width;
  if (u < margin || u > a.width * Pick(f, 20, 0.6F, 0.9F)) return kPaper;
  const bool is_large = v < 0.72F * a.height;
  if (v > 0.95F * a.height) return kPaper;
  return TextInk(u - margin, v - 0.38F * a.height, is_large ? 0.007F : 0.004F, f.seed) ? kInk : kPaper;
}

// Two arrows: this side up.
bool UpArrows(const Area& a, float x, float y) {
  if (!a.Has(x, y)) return false;
  const float u = Fraction(2 * (x - a.x) / a.width) - 0.5F, v = (y - a.y) / a.height;
  if (v < 0.08F) return true;
  if (v < 0.15F || v > 0.98F) return false;
  if (v < 0.6F) return std::abs(u) < 0.12F;
  return std::abs(u) < 0.38F * (0.98F - v) / 0.38F;
}

}  // namespace

float ParcelPrint(const Material& m, const FacePoint& f) {
  float tone = m.albedo * (1 + 0.03F * ValueNoise(f.x * 60, f.y * 400, f.seed));  // fibres
  const float long_side = std::max(f.width, f.height);
  const bool tape_along_x = f.width >= f.height;
  const float across = (tape_along_x ? f.y / f.height : f.x / f.width) - 0.5F;
  const float side = tape_along_x ? f.height : f.width;
  const int kind = static_cast<int>(Pick(f, 1, 0, 6));
  if (kind <= 1) {  // a lid: slit and tape
    if (std::abs(across) * side < 0.0008F) return 0.4F * tone;
    if (std::abs(across) * side < 0.026F) return tone * Pick(f, 2, 0.8F, 1.25F);
  } else if (kind == 2 || kind == 3) {
    const Area label{Pick(f, 3, 0.08F, 0.3F) * f.width, Pick(f, 4, 0.12F, 0.3F) * f.height,
                     std::min(0.15F, 0.6F * f.width), std::min(0.1F, 0.58F * f.height)};
    if (label.Has(f.x, f.y)) return AddressLabel(label, f.x, f.y, f);
  } else if (kind == 4) {
    const float size = 0.2F * long_side;
    const Area arrows{Pick(f, 3, 0.1F, 0.6F) * f.width, 0.25F * f.height, 0.6F * size, std::min(size, 0.6F * f.height)};
    if (UpArrows(arrows, f.x, f.y)) return m.second_albedo;
    const float height = 0.12F * f.height;
    if (WordInk(f.x - arrows.x - 0.8F * size, f.y - 0.4F * f.height, height, 6, f.seed, 0.5F)) return m.second_albedo;
  }
  // Edges of cardboard are worn a little lighter.
  const float border = std::min({f.x, f.y, f.width - f.x, f.height - f.y});
  if (border < 0.0012F) tone *= 1.06F;
  return std::min(tone, 0.9F);
}

float GroceryPrint(const Material& m, const FacePoint& f) {
  const float w = f.width, h = f.height;
  if (w < 0.45F * h && Pick(f, 1, 0, 1) < 0.7F) {  // a narrow side: contents and bar code
    const Area table{0.12F * w, 0.3F * h, 0.76F * w, 0.45F * h}, code{0.2F * w, 0.06F * h, 0.6F * w, 0.12F * h};
    if (code.Has(f.x, f.y)) return BarCode(code, f.x, f.y, f.seed) ? kInk : kPaper;
    if (table.Has(f.x, f.y)) return TextInk(f.x - table.x, f.y - table.y, 0.0028F, f.seed) ? kInk : kPaper;
    return m.albedo;
  }
  const float band_low = Pick(f, 2, 0.55F, 0.72F) * h, band_high = band_low + Pick(f, 3, 0.14F, 0.24F) * h;
  const float band = Contrast(f, 4, m.albedo);
  const bool in_band = f.y > band_low && f.y < band_high && HashUnit(5, 1, f.seed) < 0.7F;
  const float ground = in_band ? band : m.albedo;
  const int letters = 4 + static_cast<int>(Pick(f, 6, 0, 5));
  const float size = std::min(0.6F * (band_high - band_low), 0.8F * w / (static_cast<float>(letters) * 0.93F));
  const float left = 0.5F * (w - WordWidth(size, letters));
  if (WordInk(f.x - left, f.y - 0.5F * (band_low + band_high - size), size, letters, f.seed, Pick(f, 7, 0.4F, 0.75F))) {
    return Contrast(f, 8, ground);
  }
  const Area picture{0.1F * w, 0.1F * h, 0.8F * w, Pick(f, 9, 0.28F, 0.42F) * h};
  if (picture.Has(f.x, f.y)) return Picture(picture, f.x, f.y, f, m.albedo);
  const Area note{0.15F * w, 0.88F * h, 0.7F * w, 0.05F * h};
  if (note.Has(f.x, f.y) && TextInk(f.x - note.x, f.y - note.y, 0.025F * h, f.seed)) return Contrast(f, 8, ground);
  return ground;
}

float BookCover(const Material& m, const FacePoint& f) {
  // Covers are read with the long side upright.
  FacePoint p = f;
  if (f.width > f.height) p = {f.y, f.width - f.x, f.height, f.width, f.seed};
  const float w = p.width, h = p.height;
  const float ink = Contrast(p, 1, m.albedo);
  const int letters = 4 + static_cast<int>(Pick(p, 2, 0, 5));
  const float size = std::min(0.13F * h, 0.8F * w / (static_cast<float>(letters) * 0.93F));
  const float left = Pick(p, 3, 0, 1) < 0.5F ? 0.1F * w : 0.5F * (w - WordWidth(size, letters));
  if (WordInk(p.x - left, p.y - 0.76F * h, size, letters, p.seed, Pick(p, 4, 0.35F, 0.8F))) return ink;
  const Area author{0.1F * w, 0.07F * h, 0.6F * w, 0.04F * h};
  if (author.Has(p.x, p.y) && WordInk(p.x - author.x, p.y - author.y, 0.035F * h, 9, p.seed + 5, 0.5F)) return ink;
  const int kind = static_cast<int>(Pick(p, 5, 0, 4));
  const Area picture{0.1F * w, 0.16F * h, 0.8F * w, 0.52F * h};
  if (kind < 2 && picture.Has(p.x, p.y)) return Picture(picture, p.x, p.y, p, m.albedo);
  if (kind == 2 && p.y > 0.14F * h && p.y < 0.7F * h)
    return Picture({0, 0.14F * h, w, 0.56F * h}, p.x, p.y, p, m.albedo);
  return m.albedo * (1 + 0.02F * ValueNoise(p.x * 300, p.y * 300, p.seed));
}

float BookSpine(const Material& m, const FacePoint& f) {
  FacePoint p = f;
  if (f.height > f.width) p = {f.y, f.width - f.x, f.height, f.width, f.seed};
  const float size = 0.4F * p.height;
  const bool ink = WordInk(p.x - 0.12F * p.width, p.y - 0.3F * p.height, size, 8, p.seed, 0.5F);
  if (ink) return Contrast(p, 1, m.albedo);
  if (p.x > 0.92F * p.width && p.x < 0.94F * p.width) return Contrast(p, 1, m.albedo);
  return m.albedo;
}

float BookPages(const Material& m, const FacePoint& f, bool lines_along_x) {
  const float across = lines_along_x ? f.y : f.x, thickness = lines_along_x ? f.height : f.width;
  constexpr float kBoard = 0.0025F;  // m: a hard cover's edge
  if (across < kBoard || across > thickness - kBoard) return m.albedo;
  const float along = lines_along_x ? f.x : f.y;
  return 0.68F * (1 + 0.12F * ValueNoise(along * 6, across * 2500, f.seed));
}

float PosterPrint(const Material& m, const FacePoint& f) {
  const float w = f.width, h = f.height;
  const float frame = 0.018F;
  const float border = std::min({f.x, f.y, w - f.x, h - f.y});
  if (border < frame) return m.second_albedo;
  if (border < 2.2F * frame) return m.albedo;
  const Area picture{0.15F * w, 0.3F * h, 0.7F * w, 0.55F * h};
  if (picture.Has(f.x, f.y)) return Picture(picture, f.x, f.y, f, m.albedo);
  const int letters = 4 + static_cast<int>(Pick(f, 2, 0, 4));
  const float size = std::min(0.09F * h, 0.6F * w / static_cast<float>(letters));
  if (WordInk(f.x - 0.15F * w, f.y - 0.17F * h, size, letters, f.seed, 0.5F)) return Contrast(f, 1, m.albedo);
  return m.albedo;
}

float DoorPrint(const Material& m, const FacePoint& f) {
  const int notes = static_cast<int>(Pick(f, 1, 0, 7));
  for (int i = 0; i < notes; ++i) {
    FacePoint note = f;
    note.seed = f.seed + 977U * static_cast<std::uint32_t>(i + 1);
    note.width = Pick(note, 2, 0.04F, 0.13F);
    note.height = note.width * Pick(note, 3, 0.7F, 1.4F);
    note.x = f.x - Pick(note, 4, 0.15F, 0.85F) * f.width;
    note.y = f.y - Pick(note, 5, 0.2F, 0.92F) * f.height;
    if (note.x < 0 || note.y < 0 || note.x > note.width || note.y > note.height) continue;
    if (std::hypot(note.x - 0.5F * note.width, note.y - 0.93F * note.height) < 0.009F) return kInk;  // a magnet
    if (Pick(note, 6, 0, 1) < 0.5F) return Picture({0, 0, note.width, note.height}, note.x, note.y, note, m.albedo);
    const bool ink = note.x > 0.1F * note.width && note.x < 0.9F * note.width && note.y < 0.85F * note.height &&
                     TextInk(note.x, note.y, 0.06F * note.height, note.seed);
    return ink ? kInk : Pick(note, 7, 0.5F, 0.85F);
  }
  return m.albedo;
}

}  // namespace wirepose::sim
