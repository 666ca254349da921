// Letters for printed surfaces: a stroke font, so that print is sharp at any size.
#ifndef WIREPOSE_SIM_GLYPHS_H_
#define WIREPOSE_SIM_GLYPHS_H_

#include <cstdint>

namespace wirepose::sim {

// A glyph fills 4 x 6 units; the next one starts kGlyphPitch further.
inline constexpr int kGlyphs = 36;  // A to Z, 0 to 9
inline constexpr float kGlyphHeight = 6, kGlyphPitch = 5.6F;

// Is there ink at (x, y) of glyph `index`, in units from its lower left corner? `half_stroke` is
// half of the pen's width.
[[nodiscard]] bool GlyphInk(int index, float x, float y, float half_stroke);

// One word of `letters` letters in the style of a brand name (consonant, vowel, ...), `height_m`
// tall, its lower left corner at the origin. Its width is WordWidth.
[[nodiscard]] bool WordInk(float x_m, float y_m, float height_m, int letters, std::uint32_t seed, float half_stroke);
[[nodiscard]] float WordWidth(float height_m, int letters);

// Lines of running text in words; line spacing 2 `height_m`, y upwards from the lowest line.
[[nodiscard]] bool TextInk(float x_m, float y_m, float height_m, std::uint32_t seed);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_GLYPHS_H_
