#include "stages/normalize.h"

#include <algorithm>
#include <cmath>

#include "base/simd.h"

namespace wirepose {
namespace {

constexpr int kRadius = 7;
constexpr float kGain = 48;
constexpr float kNoiseFloor = 4;  // grey levels

constexpr int kWindow = 2 * kRadius + 1;
constexpr int kPadded = kMaxImageWidth + kWindow;

// Sums of values and squares over the columns of a window that slides down the image, and their running totals along
// the row, padded by kRadius repeated columns at both ends.
struct WindowSums {
  std::array<std::int32_t, kMaxImageWidth> sum{}, square{};
  std::array<std::int32_t, kPadded> sum_total{}, square_total{};
};

// Adds row `in` to the column sums and takes row `out` away.
WIREPOSE_VECTOR_KERNEL void Slide(const std::uint8_t* in, const std::uint8_t* out, int width, WindowSums& w) {
  for (int x = 0; x < width; ++x) {
    const int a = in[x], b = out[x];
    w.sum[static_cast<std::size_t>(x)] += a - b;
    w.square[static_cast<std::size_t>(x)] += a * a - b * b;
  }
}

// total[i] = sum of padded columns before i.
void Accumulate(const std::array<std::int32_t, kMaxImageWidth>& columns, int width,
                std::array<std::int32_t, kPadded>& total) {
  std::int32_t running = 0;
  std::size_t k = 0;
  total[k++] = 0;
  const auto add = [&](std::int32_t value) { total[k++] = running += value; };
  for (int i = 0; i < kRadius; ++i) add(columns[0]);
  for (int x = 0; x < width; ++x) add(columns[static_cast<std::size_t>(x)]);
  for (int i = 0; i < kRadius; ++i) add(columns[static_cast<std::size_t>(width - 1)]);
}

WIREPOSE_VECTOR_KERNEL void NormalizeRow(const std::uint8_t* in, const WindowSums& w, int width, std::uint8_t* out) {
  constexpr float kScale = 1.0F / (kWindow * kWindow);
  const std::int32_t* sum = w.sum_total.data();
  const std::int32_t* square = w.square_total.data();
  for (int x = 0; x < width; ++x) {
    const float mean = static_cast<float>(sum[x + kWindow] - sum[x]) * kScale;
    const float variance = static_cast<float>(square[x + kWindow] - square[x]) * kScale - mean * mean;
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
  for (int y = -kRadius; y <= kRadius; ++y) Slide(row(y), nothing.data(), image.width, w);
  for (int y = 0; y < image.height; ++y) {
    if (y > 0) Slide(row(y + kRadius), row(y - 1 - kRadius), image.width, w);
    Accumulate(w.sum, image.width, w.sum_total);
    Accumulate(w.square, image.width, w.square_total);
    NormalizeRow(image.row(y), w, image.width, out.data() + static_cast<std::ptrdiff_t>(y) * kMaxImageWidth);
  }
}

}  // namespace wirepose
