// A rectangle of pixels that somebody else owns.
#ifndef WIREPOSE_BASE_IMAGE_VIEW_H_
#define WIREPOSE_BASE_IMAGE_VIEW_H_

#include <cstddef>
#include <cstdint>

namespace wirepose {

// Row-major, `stride` elements from one row to the next (>= width). Does not own; valid as long as its storage.
// Pixel centres are at integer coordinates: (0, 0) is the centre of the top left pixel.
template <typename T>
struct BasicImageView {
  T* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;

  [[nodiscard]] constexpr T* row(int y) const { return data + y * stride; }
  [[nodiscard]] constexpr T& operator()(int x, int y) const { return data[y * stride + x]; }
  [[nodiscard]] constexpr bool Contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  constexpr operator BasicImageView<const T>() const { return {data, width, height, stride}; }
};

using ImageView = BasicImageView<const std::uint8_t>;
using MutableImageView = BasicImageView<std::uint8_t>;

}  // namespace wirepose

#endif  // WIREPOSE_BASE_IMAGE_VIEW_H_
