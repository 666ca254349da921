#include "stages/normalize.h"

#include <algorithm>
#include <cmath>

#include "base/simd.h"

namespace wirepose {
namespace {

constexpr int kBeside = 6;  // rows or columns of the window to each side of the block of 2 x 2 pixels
constexpr float kGain = 48;
constexpr float kNoiseFloor = 4;  // grey levels

constexpr int kWindow = 2 * kBeside + 2;
constexpr int kPairs = kMaxImageWidth / 2;
constexpr int kPairsBeside = kBeside / 2;

// Of values or of squares: sums over the rows of a window that slides down the image, and over the window itself around
// every pair of columns.
template <typename Sum>
struct WindowSums {
  std::array<Sum, kMaxImageWidth> column{};
  std::array<Sum, kPairs> window;
  std::array<Sum, kPairs + 2 * kPairsBeside> pairs, twos;
};
using ValueSums = WindowSums<std::uint16_t>;
using SquareSums = WindowSums<std::int32_t>;
static_assert(kWindow * kWindow * 255 <= 0xFFFF, "the sum of a window fits");

// Adds row `in` to the column sums and takes row `out` away.
WIREPOSE_VECTOR_KERNEL void Slide(const std::uint8_t* in, const std::uint8_t* out, int width, ValueSums& values,
                                  SquareSums& squares) {
  for (int x = 0; x < width; ++x) {
    const int a = in[x], b = out[x];
    std::uint16_t& value = values.column[static_cast<std::size_t>(x)];
    value = static_cast<std::uint16_t>(value + a - b);
    squares.column[static_cast<std::size_t>(x)] += a * a - b * b;
  }
}

// window[i] = sum of pairs i - 3 to i + 3, the first and the last column repeated beyond the borders. Sums of two and
// four pairs first: seven pairs in four additions.
template <typename Sum>
WIREPOSE_INLINE void SumWindow(int width, WindowSums<Sum>& s) {
  static_assert(kPairsBeside == 3);
  const int pairs = (width + 1) / 2;
  const Sum* c = s.column.data();
  Sum *p = s.pairs.data(), *q = s.twos.data();
  for (int i = 0; i < kPairsBeside; ++i) {
    p[i] = static_cast<Sum>(2 * c[0]);
    p[pairs + kPairsBeside + i] = static_cast<Sum>(2 * c[width - 1]);
  }
  p[pairs + kPairsBeside - 1] = static_cast<Sum>(2 * c[width - 1]);  // of an odd width; of an even one overwritten
  for (int i = 0; i < width / 2; ++i) p[i + kPairsBeside] = static_cast<Sum>(c[2 * i] + c[2 * i + 1]);
  for (int i = 0; i < pairs + 5; ++i) q[i] = static_cast<Sum>(p[i] + p[i + 1]);
  Sum* out = s.window.data();
  for (int i = 0; i < pairs; ++i) out[i] = static_cast<Sum>(q[i] + q[i + 2] + q[i + 4] + p[i + 6]);
}

// What a row's pixels are multiplied by and what is added then, the same for both columns of a pair.
struct RowScale {
  std::array<float, kMaxImageWidth> gain, offset;
};

WIREPOSE_VECTOR_KERNEL void ScaleRows(int width, ValueSums& values, SquareSums& squares, RowScale& out) {
  SumWindow(width, values);
  SumWindow(width, squares);
  constexpr float kShare = 1.0F / (kWindow * kWindow);
  for (int i = 0; i < (width + 1) / 2; ++i) {
    const float mean = static_cast<float>(values.window[static_cast<std::size_t>(i)]) * kShare;
    const float variance = static_cast<float>(squares.window[static_cast<std::size_t>(i)]) * kShare - mean * mean;
    const float gain = kGain / (std::sqrt(variance > 0 ? variance : 0.0F) + kNoiseFloor);
    const float offset = 128.5F - gain * mean;
    const auto x = static_cast<std::size_t>(2 * i);
    out.gain[x] = out.gain[x + 1] = gain;
    out.offset[x] = out.offset[x + 1] = offset;
  }
}
static_assert(kMaxImageWidth % 2 == 0, "a pair begins in every even column");

WIREPOSE_VECTOR_KERNEL void NormalizeRow(const std::uint8_t* in, int width, const RowScale& scale, std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    const auto i = static_cast<std::size_t>(x);
    const int value = static_cast<int>(static_cast<float>(in[x]) * scale.gain[i] + scale.offset[i]);
    out[x] = static_cast<std::uint8_t>(value < 0 ? 0 : (value > 255 ? 255 : value));
  }
}

}  // namespace

void NormalizeLocally(ImageView image, NormalizedPlane& out) {
  const auto row = [&](int y) { return image.row(std::clamp(y, 0, image.height - 1)); };
  ValueSums values;
  SquareSums squares;
  RowScale scale;
  const std::array<std::uint8_t, kMaxImageWidth> nothing{};
  for (int y = -kBeside; y < kBeside + 2; ++y) Slide(row(y), nothing.data(), image.width, values, squares);
  for (int y = 0; y < image.height; ++y) {
    if (y % 2 == 0) {
      if (y > 0) {
        Slide(row(y + kBeside), row(y - 2 - kBeside), image.width, values, squares);
        Slide(row(y + kBeside + 1), row(y - 1 - kBeside), image.width, values, squares);
      }
      ScaleRows(image.width, values, squares, scale);
    }
    NormalizeRow(image.row(y), image.width, scale, out.data() + static_cast<std::ptrdiff_t>(y) * kMaxImageWidth);
  }
}

}  // namespace wirepose
