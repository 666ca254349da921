#include "stages/normalize.h"

#include <algorithm>
#include <cmath>

#include "base/simd.h"

namespace wirepose {
namespace {

constexpr int kWindowRadius = 7;
constexpr float kGain = 48;
constexpr float kNoiseFloor = 4;  // grey levels

constexpr int kWindow = 2 * kWindowRadius + 1;
using PaddedRow = std::array<std::int32_t, kMaxImageWidth + kWindow - 1>;

// Sums of values and squares over the columns of a window that slides down the image, and over the window itself.
struct WindowSums {
  std::array<std::int32_t, kMaxImageWidth> sum{}, square{};
  std::array<std::int32_t, kMaxImageWidth> window_sum, window_square;
  std::array<PaddedRow, 2> work;
};

// Adds row `in` to the column sums and takes row `out` away.
WIREPOSE_VECTOR_KERNEL void Slide(const std::uint8_t* in, const std::uint8_t* out, int width, WindowSums& w) {
  for (int x = 0; x < width; ++x) {
    const int a = in[x], b = out[x];
    w.sum[static_cast<std::size_t>(x)] += a - b;
    w.square[static_cast<std::size_t>(x)] += a * a - b * b;
  }
}

// out[x] = sum of columns x - kWindowRadius to x + kWindowRadius, the first and the last one repeated beyond the
// borders. Sums of two, four and eight neighbours first: fifteen columns in five vector additions.
WIREPOSE_INLINE void SumWindow(const std::array<std::int32_t, kMaxImageWidth>& columns, int width, PaddedRow& a,
                               PaddedRow& b, std::array<std::int32_t, kMaxImageWidth>& out) {
  static_assert(kWindowRadius == 7);
  const int padded = width + kWindow - 1;
  for (int i = 0; i < kWindowRadius; ++i) {
    a[static_cast<std::size_t>(i)] = columns[0];
    a[static_cast<std::size_t>(kWindowRadius + width + i)] = columns[static_cast<std::size_t>(width - 1)];
  }
  std::copy(columns.begin(), columns.begin() + width, a.begin() + kWindowRadius);
  std::int32_t *p = a.data(), *q = b.data();
  for (int i = 0; i < width; ++i) out[static_cast<std::size_t>(i)] = -p[i + kWindowRadius];
  for (int i = 0; i < padded - 1; ++i) q[i] = p[i] + p[i + 1];
  for (int i = 0; i < padded - 3; ++i) p[i] = q[i] + q[i + 2];
  for (int i = 0; i < padded - 7; ++i) q[i] = p[i] + p[i + 4];
  for (int i = 0; i < width; ++i) out[static_cast<std::size_t>(i)] += q[i] + q[i + kWindowRadius];
}

WIREPOSE_VECTOR_KERNEL void NormalizeRow(const std::uint8_t* in, int width, WindowSums& w, std::uint8_t* out) {
  SumWindow(w.sum, width, w.work[0], w.work[1], w.window_sum);
  SumWindow(w.square, width, w.work[0], w.work[1], w.window_square);
  constexpr float kScale = 1.0F / (kWindow * kWindow);
  for (int x = 0; x < width; ++x) {
    const auto i = static_cast<std::size_t>(x);
    const float mean = static_cast<float>(w.window_sum[i]) * kScale;
    const float variance = static_cast<float>(w.window_square[i]) * kScale - mean * mean;
    const float deviation = std::sqrt(variance > 0 ? variance : 0.0F);
    const float value = 128.5F + kGain * (static_cast<float>(in[x]) - mean) / (deviation + kNoiseFloor);
    const int rounded = static_cast<int>(value);
    out[x] = static_cast<std::uint8_t>(rounded < 0 ? 0 : (rounded > 255 ? 255 : rounded));
  }
}

}  // namespace

void NormalizeLocally(ImageView image, NormalizedPlane& out) {
  const auto row = [&](int y) { return image.row(std::max(0, std::min(y, image.height - 1))); };
  WindowSums w;
  const std::array<std::uint8_t, kMaxImageWidth> nothing{};
  for (int y = -kWindowRadius; y <= kWindowRadius; ++y) Slide(row(y), nothing.data(), image.width, w);
  for (int y = 0; y < image.height; ++y) {
    if (y > 0) Slide(row(y + kWindowRadius), row(y - 1 - kWindowRadius), image.width, w);
    NormalizeRow(image.row(y), image.width, w, out.data() + static_cast<std::ptrdiff_t>(y) * kMaxImageWidth);
  }
}

}  // namespace wirepose
