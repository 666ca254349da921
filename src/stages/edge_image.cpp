#include "stages/edge_image.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "base/simd.h"

namespace wirepose {
namespace {

constexpr int kBorder = 3;
constexpr std::size_t kLastBucket = 16384 / 16;  // sqrt(2) * 255 * 32 fits below

// Horizontal pass of one row: times 16, borders repeated.
void FilterRow(const std::uint8_t* in, int width, std::int16_t* out) {
  const auto at = [&](int x) { return static_cast<int>(in[std::clamp(x, 0, width - 1)]); };
  const auto tap = [](int a, int b, int c, int d, int e) {
    return static_cast<std::int16_t>(a + 4 * b + 6 * c + 4 * d + e);
  };
  for (int x : {0, 1, width - 2, width - 1}) out[x] = tap(at(x - 2), at(x - 1), at(x), at(x + 1), at(x + 2));
  for (int x = 2; x < width - 2; ++x) out[x] = tap(in[x - 2], in[x - 1], in[x], in[x + 1], in[x + 2]);
}

// Magnitude below which half of the pixels lie. For pure noise the magnitude is Rayleigh distributed and its median is
// 1.18 sigma; in a real image flat areas dominate, so the value is an upper bound close to it.
int MedianMagnitude(const EdgeImage& image) {
  std::array<std::uint32_t, 512> histogram{};
  std::uint32_t count = 0;
  for (int y = kBorder; y < image.height - kBorder; y += 4) {
    for (int x = kBorder; x < image.width - kBorder; ++x) {
      ++histogram[std::min<std::size_t>(image.magnitude[EdgeImage::Index(x, y)], histogram.size() - 1)];
      ++count;
    }
  }
  std::uint32_t below = 0;
  for (std::size_t m = 0; m < histogram.size(); ++m) {
    below += histogram[m];
    if (2 * below >= count) return static_cast<int>(m);
  }
  return static_cast<int>(histogram.size());
}

WIREPOSE_VECTOR_KERNEL void ComputeGradient(const SmoothPlane& smooth, EdgeImage& out) {
  for (int y = 0; y < out.height; ++y) {
    const std::int16_t* row = smooth.data() + y * kStride;
    const std::int16_t* above = y > 0 ? row - kStride : row;
    const std::int16_t* below = y + 1 < out.height ? row + kStride : row;
    std::int16_t* gx = out.gx.data() + y * kStride;
    std::int16_t* gy = out.gy.data() + y * kStride;
    std::uint16_t* magnitude = out.magnitude.data() + y * kStride;
    gx[0] = gx[out.width - 1] = 0;
    for (int x = 1; x < out.width - 1; ++x) gx[x] = static_cast<std::int16_t>(row[x + 1] - row[x - 1]);
    for (int x = 0; x < out.width; ++x) gy[x] = static_cast<std::int16_t>(below[x] - above[x]);
    for (int x = 0; x < out.width; ++x) {
      const auto square = static_cast<float>(gx[x] * gx[x] + gy[x] * gy[x]);
      magnitude[x] = static_cast<std::uint16_t>(std::sqrt(square));
    }
  }
}

// Marks the ridge pixels of columns [begin, end) of a row. The larger gradient component tells the direction in which
// neighbours are compared. One side compares with >=, so that a plateau of two equal pixels yields one ridge pixel.
WIREPOSE_VECTOR_KERNEL void MarkRidges(const EdgeImage& image, int y, int begin, int end, std::uint16_t threshold,
                                       std::uint8_t* ridge) {
  const std::ptrdiff_t row = y * kStride;
  const std::int16_t* gx = image.gx.data() + row;
  const std::int16_t* gy = image.gy.data() + row;
  const std::uint16_t* here = image.magnitude.data() + row;
  // Sixteen bits until the end: lanes of one width.
  constexpr std::uint16_t kNone = 0, kAcrossX = static_cast<std::uint16_t>(Ridge::kAcrossX),
                          kAcrossY = static_cast<std::uint16_t>(Ridge::kAcrossY);
  std::array<std::uint16_t, kMaxImageWidth> kinds;
  for (int x = begin; x < end; ++x) {
    const auto ax = static_cast<std::int16_t>(std::abs(int{gx[x]})),
               ay = static_cast<std::int16_t>(std::abs(int{gy[x]}));
    const std::uint16_t m = here[x], left = here[x - 1], right = here[x + 1], above = here[x - kStride],
                        below = here[x + kStride];
    // Without && nothing branches, and the loop vectorizes.
    const std::uint16_t by_x = static_cast<std::uint16_t>((m > left) & (m >= right)) * kAcrossX;
    const std::uint16_t by_y = static_cast<std::uint16_t>((m > above) & (m >= below)) * kAcrossY;
    const std::uint16_t kind = ax >= ay ? by_x : by_y;
    kinds[static_cast<std::size_t>(x)] = m >= threshold ? kind : kNone;
  }
  for (int x = begin; x < end; ++x) ridge[x] = static_cast<std::uint8_t>(kinds[static_cast<std::size_t>(x)]);
}

std::size_t BucketOf(std::uint16_t magnitude) { return std::min<std::size_t>(magnitude / 16, kLastBucket); }

// Calls use(i) for every ridge pixel with at least `threshold` of magnitude, and writes its kind to image.ridge.
template <typename Use>
void ForEachRidge(const RectificationMap& map, std::uint16_t threshold, EdgeImage& image, const Use& use) {
  for (int y = kBorder; y < image.height - kBorder; ++y) {
    const auto [first, last] = map.valid[static_cast<std::size_t>(y)];
    const int begin = first + kBorder, end = last - kBorder;
    std::uint8_t* row = image.ridge.data() + EdgeImage::Index(0, y);
    MarkRidges(image, y, begin, end, threshold, row);
    for (int x = begin; x < end; ++x) {
      // Most pixels are none: eight at a time.
      std::uint64_t eight = 0;
      while (x + 8 <= end && (std::memcpy(&eight, row + x, 8), eight == 0)) x += 8;
      if (x < end && row[x] != 0) use(static_cast<std::uint32_t>(EdgeImage::Index(x, y)));
    }
  }
}

void ClearRidges(EdgeImage& image) {
  for (int y = 0; y < image.height; ++y) {
    std::uint8_t* row = image.ridge.data() + EdgeImage::Index(0, y);
    std::fill(row, row + image.width, std::uint8_t{0});
  }
  image.ridge_count = image.ridge_dropped = 0;
}

// After an overflow: counts all ridges by strength and collects again, the strongest only.
void CollectStrongest(const RectificationMap& map, EdgeImage& image) {
  std::array<std::uint32_t, kLastBucket + 1> histogram{};
  ClearRidges(image);
  std::uint32_t total = 0;
  ForEachRidge(map, image.threshold, image, [&](std::uint32_t i) {
    ++histogram[BucketOf(image.magnitude[i])];
    ++total;
  });
  std::size_t border = kLastBucket;  // the strength of which only some have room
  std::uint32_t stronger = 0;
  while (border > 0 && stronger + histogram[border] <= kMaxRidgePixels) stronger += histogram[border--];
  std::uint32_t room = static_cast<std::uint32_t>(kMaxRidgePixels) - stronger;
  ClearRidges(image);
  const auto threshold = std::max<std::size_t>(border * 16, image.threshold);
  ForEachRidge(map, static_cast<std::uint16_t>(threshold), image, [&](std::uint32_t i) {
    if (BucketOf(image.magnitude[i]) == border && room-- == 0) {
      ++room;
      image.ridge[i] = 0;
    } else {
      image.ridge_pixels[image.ridge_count++] = i;
    }
  });
  image.ridge_dropped = total - image.ridge_count;
}

void CollectRidges(const RectificationMap& map, EdgeImage& image) {
  ClearRidges(image);
  ForEachRidge(map, image.threshold, image, [&](std::uint32_t i) {
    if (image.ridge_count < kMaxRidgePixels) {
      image.ridge_pixels[image.ridge_count++] = i;
    } else {
      ++image.ridge_dropped;
    }
  });
  if (image.ridge_dropped > 0) CollectStrongest(map, image);
}

}  // namespace

WIREPOSE_VECTOR_KERNEL void SmoothImage(ImageView image, SmoothPlane& smooth) {
  // A ring of five filtered rows: each output row needs two above and two below, borders repeated.
  std::array<std::array<std::int16_t, kMaxImageWidth>, 5> ring;
  const auto filtered = [&](int y) -> const std::int16_t* {
    return ring[static_cast<std::size_t>(std::clamp(y, 0, image.height - 1) % 5)].data();
  };
  for (int y = 0; y < 2; ++y) FilterRow(image.row(y), image.width, ring[static_cast<std::size_t>(y)].data());
  for (int y = 0; y < image.height; ++y) {
    if (y + 2 < image.height) {
      FilterRow(image.row(y + 2), image.width, ring[static_cast<std::size_t>((y + 2) % 5)].data());
    }
    const std::int16_t* a = filtered(y - 2);
    const std::int16_t* b = filtered(y - 1);
    const std::int16_t* c = filtered(y);
    const std::int16_t* d = filtered(y + 1);
    const std::int16_t* e = filtered(y + 2);
    std::int16_t* out = smooth.data() + y * kStride;
    for (int x = 0; x < image.width; ++x) {
      out[x] = static_cast<std::int16_t>((a[x] + 4 * b[x] + 6 * c[x] + 4 * d[x] + e[x] + 8) / kSmoothOne);
    }
  }
}

void FindRidges(const SmoothPlane& smooth, int width, int height, const RectificationMap& map,
                const EdgeImageParams& params, EdgeImage& out) {
  out.width = width;
  out.height = height;
  ComputeGradient(smooth, out);
  const float noise = static_cast<float>(MedianMagnitude(out)) / 1.18F;
  const float threshold = std::max(params.noise_factor * noise, params.min_gradient * kGradientOne);
  // Texture everywhere must not silence the edges: the noise estimate is trusted up to 4 grey levels per pixel.
  out.threshold = static_cast<std::uint16_t>(std::min(threshold, 4.0F * kGradientOne));
  CollectRidges(map, out);
}

// Counting sort.
void SortRidges(EdgeImage& image) {
  std::array<std::uint32_t, kLastBucket + 1> start{};
  const std::span<const std::uint32_t> pixels(image.ridge_pixels.data(), image.ridge_count);
  const auto place = [&](std::uint32_t i) -> std::uint32_t& {
    return start[kLastBucket - BucketOf(image.magnitude[i])];
  };
  for (const std::uint32_t i : pixels) ++place(i);
  std::uint32_t sum = 0;
  for (std::uint32_t& s : start) {
    const std::uint32_t count = s;
    s = sum;
    sum += count;
  }
  for (const std::uint32_t i : pixels) image.by_magnitude[place(i)++] = i;
}

}  // namespace wirepose
