#include "sim/glyphs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "sim/noise.h"

namespace wirepose::sim {
namespace {

// Strokes of each glyph: pairs of digits are points (x, y), a blank lifts the pen.
constexpr std::array<std::string_view, kGlyphs> kStrokes = {"002640 1333",
                                                            "00063645443303 3342413000",
                                                            "4536160501103041",
                                                            "00062644422000",
                                                            "46060040 0333",
                                                            "460600 0333",
                                                            "45361605011030414323",
                                                            "0006 4046 0343",
                                                            "2026",
                                                            "4641301001",
                                                            "0006 460340",
                                                            "060040",
                                                            "0006234640",
                                                            "00064046",
                                                            "103041453616050110",
                                                            "00063645443303",
                                                            "103041453616050110 2240",
                                                            "00063645443303 2340",
                                                            "453616050413334241301001",
                                                            "0646 2620",
                                                            "060110304146",
                                                            "062046",
                                                            "0610233046",
                                                            "0640 4600",
                                                            "062346 2320",
                                                            "06460040",
                                                            "103041453616050110 0145",
                                                            "152620",
                                                            "05163645440040",
                                                            "0646234241301001",
                                                            "3036 3602 0242",
                                                            "46060333424130 1001",
                                                            "4536160501103041423303",
                                                            "064620",
                                                            "1304051636454433130201103041423313",
                                                            "0110304145361605041343"};

struct Stroke {
  float x0, y0, x1, y1;
};

std::vector<Stroke> ParseGlyph(std::string_view text) {
  std::vector<Stroke> strokes;
  bool is_down = false;
  float x = 0, y = 0;
  for (std::size_t i = 0; i + 1 < text.size();) {
    if (text[i] == ' ') {
      is_down = false;
      ++i;
      continue;
    }
    const auto next_x = static_cast<float>(text[i] - '0'), next_y = static_cast<float>(text[i + 1] - '0');
    if (is_down) strokes.push_back({x, y, next_x, next_y});
    x = next_x;
    y = next_y;
    is_down = true;
    i += 2;
  }
  return strokes;
}

const std::array<std::vector<Stroke>, kGlyphs>& Glyphs() {
  static const auto glyphs = [] {
    std::array<std::vector<Stroke>, kGlyphs> all;
    std::transform(kStrokes.begin(), kStrokes.end(), all.begin(), ParseGlyph);
    return all;
  }();
  return glyphs;
}

int Letter(int column, std::uint32_t seed) {
  constexpr std::string_view kVowels = "AEIOU", kConsonants = "BCDFGHKLMNPRSTVZ";
  const std::string_view& set = (static_cast<std::uint32_t>(column) + seed) % 2 == 0 ? kVowels : kConsonants;
  const auto pick = static_cast<std::size_t>(HashUnit(column, 3, seed) * static_cast<float>(set.size()));
  return set[pick] - 'A';
}

}  // namespace

bool GlyphInk(int index, float x, float y, float half_stroke) {
  if (x < -half_stroke || y < -half_stroke || x > 4 + half_stroke || y > kGlyphHeight + half_stroke) return false;
  const std::vector<Stroke>& strokes = Glyphs()[static_cast<std::size_t>(index)];
  return std::any_of(strokes.begin(), strokes.end(), [&](const Stroke& s) {
    const float dx = s.x1 - s.x0, dy = s.y1 - s.y0;
    const float along = std::clamp(((x - s.x0) * dx + (y - s.y0) * dy) / (dx * dx + dy * dy), 0.0F, 1.0F);
    const float ex = x - s.x0 - along * dx, ey = y - s.y0 - along * dy;
    return ex * ex + ey * ey < half_stroke * half_stroke;
  });
}

bool WordInk(float x_m, float y_m, float height_m, int letters, std::uint32_t seed, float half_stroke) {
  const float unit = height_m / kGlyphHeight;
  const float x = x_m / unit, y = y_m / unit;
  if (y < -1 || y > kGlyphHeight + 1) return false;
  const int column = Floor(x / kGlyphPitch);
  if (column < 0 || column >= letters) return false;
  return GlyphInk(Letter(column, seed), x - static_cast<float>(column) * kGlyphPitch, y, half_stroke);
}

float WordWidth(float height_m, int letters) {
  return (static_cast<float>(letters) * kGlyphPitch - 1.6F) * height_m / kGlyphHeight;
}

bool TextInk(float x_m, float y_m, float height_m, std::uint32_t seed) {
  constexpr float kLineSpacing = 2;
  const int line = Floor(y_m / (kLineSpacing * height_m));
  const float unit = height_m / kGlyphHeight;
  const float y = (y_m - static_cast<float>(line) * kLineSpacing * height_m) / unit;
  if (y > kGlyphHeight + 0.5F) return false;
  const float x = x_m / unit;
  const int column = Floor(x / kGlyphPitch);
  if (HashUnit(column, line, seed) < 0.2F) return false;  // the gap between two words
  const int glyph = static_cast<int>(HashUnit(column, line, seed + 7) * kGlyphs);
  return GlyphInk(glyph, x - static_cast<float>(column) * kGlyphPitch, y, 0.55F);
}

}  // namespace wirepose::sim
