// The disparity map against a plain implementation of its recursion, and against planes of known disparity.
#include "stages/disparity_map.h"

#include <gtest/gtest.h>

#include <vector>

#include "stage_test_support.h"

namespace wirepose {
namespace {

using testing::GrayImage;
using testing::Paint;
using testing::Random;

std::unique_ptr<NormalizedPlane> PlaneOf(const GrayImage& image) {
  auto plane = std::make_unique<NormalizedPlane>();
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) (*plane)[EdgeImage::Index(x, y)] = image.view()(x, y);
  }
  return plane;
}

// Of images whose values are taken as normalised already.
std::unique_ptr<DisparityMap> MapOf(const GrayImage& left, const GrayImage& right) {
  const auto l = PlaneOf(left), r = PlaneOf(right);
  const auto scratch = std::make_unique<DisparityScratch>();
  auto map = std::make_unique<DisparityMap>();
  ComputeDisparityMap({}, left.width, left.height, *l, *r, *scratch, *map);
  return map;
}

// The slow twin: every array in full, every definition as it is written down.
class Twin {
 public:
  Twin(const GrayImage& left, const GrayImage& right)
      : w_(left.width / 2), h_(left.height / 2), left_(left), right_(right) {
    Sum();
    Choose();
  }

  [[nodiscard]] int At(int x, int row) const {
    const int y = row / kRowStep * kRowStep;  // the row that was matched for this one
    const int here = raw_[Index(x, y)];
    int confirmed = 0;
    for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -kRowStep}, {0, kRowStep}}) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= w_ || y + dy >= h_) continue;
      if (std::abs(raw_[Index(x + dx, y + dy)] - here) <= 16) ++confirmed;
    }
    return confirmed >= 2 ? here : 0;
  }

 private:
  static constexpr int kN = kMapDisparities;
  using Path = std::vector<int>;

  [[nodiscard]] std::size_t Index(int x, int y) const { return static_cast<std::size_t>(y * w_ + x); }
  static int Half(const GrayImage& image, int x, int y) {
    const auto at = [&](int u, int v) { return int{image.view()(u, v)}; };
    return (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) + at(2 * x, 2 * y + 1) + at(2 * x + 1, 2 * y + 1) + 2) / 4;
  }
  [[nodiscard]] int Difference(int x, int y, int d) const {
    x = std::clamp(x, 0, w_ - 1);
    y = std::clamp(y, 0, h_ - 1);
    return d > x ? 12 : std::min(12, std::abs(Half(left_, x, y) - Half(right_, x - d, y)) / 8);
  }
  [[nodiscard]] int Cost(int x, int y, int d) const {
    int sum = 0;
    for (int v = y - 1; v <= y + 1; ++v) {
      for (int u = x - 1; u <= x + 1; ++u) sum += Difference(u, v, d);
    }
    return sum;
  }
  [[nodiscard]] Path Next(const Path& previous, int x, int y) const {
    Path next(kN);
    const int lowest = previous.empty() ? 0 : *std::min_element(previous.begin(), previous.end());
    for (int d = 0; d < kN; ++d) {
      int best = 0;
      if (!previous.empty()) {
        best = std::min(previous[static_cast<std::size_t>(d)], lowest + 88);
        if (d > 0) best = std::min(best, previous[static_cast<std::size_t>(d - 1)] + 22);
        if (d + 1 < kN) best = std::min(best, previous[static_cast<std::size_t>(d + 1)] + 22);
      }
      next[static_cast<std::size_t>(d)] = Cost(x, y, d) + best - lowest;
    }
    return next;
  }
  void Add(const Path& path, int x, int y) {
    for (int d = 0; d < kN; ++d)
      sum_[Index(x, y) * kN + static_cast<std::size_t>(d)] += path[static_cast<std::size_t>(d)];
  }
  void Sum() {
    sum_.assign(static_cast<std::size_t>(w_ * h_) * kN, 0);
    for (int y = 0; y < h_; ++y) {
      Path path;
      for (int x = 0; x < w_; ++x) Add(path = Next(path, x, y), x, y);
      path.clear();
      for (int x = w_ - 1; x >= 0; --x) Add(path = Next(path, x, y), x, y);
    }
    for (int x = 0; x < w_; ++x) {
      Path path;
      for (int y = 0; y < h_; y += kRowStep) Add(path = Next(path, x, y), x, y);
    }
  }
  void Choose() {
    raw_.assign(static_cast<std::size_t>(w_ * h_), 0);
    for (int y = 0; y < h_; ++y) {
      std::vector<int> left(static_cast<std::size_t>(w_)), right(left), cost(left.size(), 1 << 20);
      for (int x = 0; x < w_; ++x) {
        const auto begin = sum_.begin() + static_cast<std::ptrdiff_t>(Index(x, y) * kN);
        const int d = static_cast<int>(std::min_element(begin, begin + kN) - begin);
        left[static_cast<std::size_t>(x)] = d;
        if (d > x || begin[d] >= cost[static_cast<std::size_t>(x - d)]) continue;
        cost[static_cast<std::size_t>(x - d)] = begin[d];
        right[static_cast<std::size_t>(x - d)] = d;
      }
      for (int x = 0; x < w_; ++x) {
        const int d = left[static_cast<std::size_t>(x)];
        if (d == 0 || d > x || std::abs(right[static_cast<std::size_t>(x - d)] - d) > 1) continue;
        const int* s = sum_.data() + Index(x, y) * kN + d;
        const int bend = d + 1 < kN ? s[-1] - 2 * s[0] + s[1] : 0;
        raw_[Index(x, y)] = 16 * d + (bend > 0 ? (s[-1] - s[1]) * 16 / (2 * bend) : 0);
      }
    }
  }

  int w_, h_;
  const GrayImage& left_;
  const GrayImage& right_;
  std::vector<int> sum_, raw_;
};

void ExpectAsTwin(const GrayImage& left, const GrayImage& right) {
  const auto map = MapOf(left, right);
  const Twin twin(left, right);
  for (int y = 0; y < map->height; ++y) {
    for (int x = 0; x < map->width; ++x) {
      ASSERT_EQ(map->disparity[static_cast<std::size_t>(y * DisparityMap::kMaxWidth + x)], twin.At(x, y))
          << x << " " << y;
    }
  }
}

TEST(DisparityMap, AgreesWithTheTwin) {
  Random random(3);
  for (int k = 0; k < testing::Cases(10); ++k) {
    const double shift = random.Uniform(3, 25), slope = random.Uniform(-0.1, 0.1);
    const auto seed = random.Next();
    const GrayImage left = Paint(
        96, 30, [&](int x, int y) { return 128 + 100 * testing::Texture(x, y, 5, seed) + random.Uniform(-8, 8); });
    const GrayImage right = Paint(96, 30, [&](int x, int y) {
      return 128 + 100 * testing::Texture(x + shift + slope * y, y, 5, seed) + random.Uniform(-8, 8);
    });
    ExpectAsTwin(left, right);
  }
}

// Costs as high as they get, in odd and in the smallest sizes.
TEST(DisparityMap, AgreesWithTheTwinOnBlackAndWhite) {
  Random random(7);
  const auto noise = [&](int, int) { return random.Uniform(0, 1) < 0.5 ? 0 : 255; };
  for (const auto& [width, height] : {std::pair(64, 64), {65, 67}, {200, 31}}) {
    ExpectAsTwin(Paint(width, height, noise), Paint(width, height, noise));
    ExpectAsTwin(Paint(width, height, [](int, int) { return 0; }), Paint(width, height, [](int, int) { return 255; }));
  }
}

// A textured plane, its disparity affine in the image, through local normalisation and with the right camera darker.
TEST(DisparityMap, MeasuresPlanes) {
  Random random(4);
  for (int k = 0; k < testing::Cases(6); ++k) {
    const double d0 = random.Uniform(10, 110), by_row = random.Uniform(-0.08, 0.08);
    const auto seed = random.Next();
    const auto expected = [&](int y) { return d0 + by_row * (y - 120); };
    const GrayImage left = Paint(
        320, 240, [&](int x, int y) { return 120 + 70 * testing::Texture(x, y, 6, seed) + testing::Gaussian(random); });
    const GrayImage right = Paint(320, 240, [&](int x, int y) {
      return 0.66 * (120 + 70 * testing::Texture(x + expected(y), y, 6, seed)) + testing::Gaussian(random);
    });
    auto l = std::make_unique<NormalizedPlane>(), r = std::make_unique<NormalizedPlane>();
    NormalizeLocally(left.view(), *l);
    NormalizeLocally(right.view(), *r);
    const auto scratch = std::make_unique<DisparityScratch>();
    const auto map = std::make_unique<DisparityMap>();
    ComputeDisparityMap({}, 320, 240, *l, *r, *scratch, *map);
    int known = 0, right_ones = 0, seen = 0;
    for (int y = 4; y < 236; y += 2) {
      for (int x = 4 + static_cast<int>(expected(y) + 8); x < 316; x += 2) {
        ++seen;
        const float d = map->At(x, y);
        if (d <= 0) continue;
        ++known;
        if (std::abs(static_cast<double>(d) - expected(y)) < 1) ++right_ones;
      }
    }
    EXPECT_GT(known, 0.95 * seen) << d0;
    EXPECT_GT(right_ones, 0.97 * known) << d0;
  }
}

TEST(DisparityMap, BlankImagesAreUnknown) {
  const GrayImage blank = Paint(160, 120, [](int, int) { return 128; });
  const auto map = MapOf(blank, blank);
  for (int y = 0; y < map->height; ++y) {
    for (int x = 0; x < map->width; ++x) ASSERT_EQ(map->At(2 * x, 2 * y), 0) << x << " " << y;
  }
}

// What only one image shows is not confirmed by the other.
TEST(DisparityMap, UnrelatedImagesAreMostlyUnknown) {
  Random random(5);
  const GrayImage left = Paint(320, 240, [&](int, int) { return random.Uniform(0, 255); });
  const GrayImage right = Paint(320, 240, [&](int, int) { return random.Uniform(0, 255); });
  const auto map = MapOf(left, right);
  int known = 0;
  for (int y = 0; y < map->height; ++y) {
    for (int x = 0; x < map->width; ++x) known += map->At(2 * x, 2 * y) > 0 ? 1 : 0;
  }
  EXPECT_LT(known, map->width * map->height / 3);
}

}  // namespace
}  // namespace wirepose
