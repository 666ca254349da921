#include "stages/normalize.h"

#include <algorithm>
#include <cmath>

namespace wirepose {
namespace {

constexpr int kRadius = 7;
constexpr float kGain = 48;
constexpr float kNoiseFloor = 4;  // grey levels

// Sums of values and squares over the columns of a window that slides down the image; borders repeat.
class ColumnSums {
 public:
  explicit ColumnSums(ImageView image) : image_(image) {
    for (int y = -kRadius; y <= kRadius; ++y) Accumulate(y, 1);
  }
  void Advance(int y) {  // from the window centred on y - 1 to the one centred on y
    Accumulate(y + kRadius, 1);
    Accumulate(y - 1 - kRadius, -1);
  }
  [[nodiscard]] int sum(int x) const { return sum_[Clamp(x)]; }
  [[nodiscard]] int square(int x) const { return square_[Clamp(x)]; }

 private:
  [[nodiscard]] std::size_t Clamp(int x) const {
    return static_cast<std::size_t>(std::max(0, std::min(x, image_.width - 1)));
  }
  void Accumulate(int y, int sign) {
    const std::uint8_t* row = image_.row(std::clamp(y, 0, image_.height - 1));
    for (int x = 0; x < image_.width; ++x) {
      sum_[static_cast<std::size_t>(x)] += sign * row[x];
      square_[static_cast<std::size_t>(x)] += sign * row[x] * row[x];
    }
  }

  ImageView image_;
  std::array<std::int32_t, kMaxImageWidth> sum_{}, square_{};
};

}  // namespace

void NormalizeLocally(ImageView image, NormalizedPlane& out) {
  constexpr auto kArea = static_cast<float>((2 * kRadius + 1) * (2 * kRadius + 1));
  ColumnSums columns(image);
  std::array<float, kMaxImageWidth> mean, scale;
  for (int y = 0; y < image.height; ++y) {
    if (y > 0) columns.Advance(y);
    int sum = 0, square = 0;
    for (int x = -kRadius; x < kRadius; ++x) {
      sum += columns.sum(x);
      square += columns.square(x);
    }
    for (int x = 0; x < image.width; ++x) {
      sum += columns.sum(x + kRadius);
      square += columns.square(x + kRadius);
      const float m = static_cast<float>(sum) / kArea;
      const float variance = std::max(0.0F, static_cast<float>(square) / kArea - m * m);
      mean[static_cast<std::size_t>(x)] = m;
      scale[static_cast<std::size_t>(x)] = variance;
      sum -= columns.sum(x - kRadius);
      square -= columns.square(x - kRadius);
    }
    const std::uint8_t* in = image.row(y);
    std::uint8_t* row = out.data() + static_cast<std::ptrdiff_t>(y) * kMaxImageWidth;
    for (int x = 0; x < image.width; ++x) {
      const auto i = static_cast<std::size_t>(x);
      const float value = 128.5F + kGain * (static_cast<float>(in[x]) - mean[i]) / (std::sqrt(scale[i]) + kNoiseFloor);
      row[x] = static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F));
    }
  }
}

}  // namespace wirepose
