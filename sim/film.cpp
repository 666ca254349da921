#include "sim/film.h"

#include <cmath>

#include "sim/parallel.h"

namespace wirepose::sim {
namespace {

double NormalCdf(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

// Weights of the samples along one axis, from the first sample of the film that a pixel draws from:
// the Gaussian blurred by the pixel's own width.
std::vector<float> PsfWeights(const Film& film, double sigma_px) {
  const int count = (2 * film.margin + 1) * film.side;
  std::vector<double> weights;
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    const double d = (i + 0.5) / film.side - film.margin - 0.5;  // px from the pixel's centre
    const double w =
        sigma_px > 0 ? NormalCdf((d + 0.5) / sigma_px) - NormalCdf((d - 0.5) / sigma_px) : 1.0 * (std::abs(d) < 0.5);
    weights.push_back(w);
    sum += w;
  }
  std::vector<float> normalized;
  for (const double w : weights) normalized.push_back(static_cast<float>(w / sum));
  return normalized;
}

// Less light towards the corners, as the square of the distance from the principal point.
void Vignette(const Camera& camera, RadianceImage& image) {
  const double half = 0.25 * (double(camera.width) * camera.width + double(camera.height) * camera.height);
  for (int y = 0; y < image.height; ++y) {
    const double dy = y - camera.intrinsics.cy;
    for (int x = 0; x < image.width; ++x) {
      const double dx = x - camera.intrinsics.cx;
      image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)] *=
          static_cast<float>(1 - camera.vignetting * (dx * dx + dy * dy) / half);
    }
  }
}

}  // namespace

Film::Film(const Camera& camera, int samples_per_side)
    : side(samples_per_side),
      margin(static_cast<int>(std::ceil(3 * camera.psf_sigma_px))),
      width((camera.width + 2 * margin) * side),
      height((camera.height + 2 * margin) * side),
      samples(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

// Along the rows first, then along the columns.
RadianceImage Develop(const Film& film, const Camera& camera, int threads) {
  const std::vector<float> weights = PsfWeights(film, camera.psf_sigma_px);
  const int taps = static_cast<int>(weights.size());
  const auto width = static_cast<std::size_t>(camera.width);
  std::vector<float> narrow(static_cast<std::size_t>(film.height) * width);
  ForEachRow(film.height, threads, [&](int y) {
    const float* in = film.row(y);
    float* out = narrow.data() + static_cast<std::size_t>(y) * width;
    for (int x = 0; x < camera.width; ++x, in += film.side) {
      float sum = 0;
      for (int i = 0; i < taps; ++i) sum += weights[static_cast<std::size_t>(i)] * in[i];
      out[x] = sum;
    }
  });
  RadianceImage image{camera.width, camera.height, {}};
  image.pixels.resize(width * static_cast<std::size_t>(camera.height));
  ForEachRow(camera.height, threads, [&](int y) {
    float* out = image.pixels.data() + static_cast<std::size_t>(y) * width;
    for (int i = 0; i < taps; ++i) {
      const float w = weights[static_cast<std::size_t>(i)];
      const float* in = narrow.data() + static_cast<std::size_t>(y * film.side + i) * width;
      for (std::size_t x = 0; x < width; ++x) out[x] += w * in[x];
    }
  });
  if (camera.vignetting > 0) Vignette(camera, image);
  return image;
}

}  // namespace wirepose::sim
