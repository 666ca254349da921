// Small worlds for the tests of the stages: images as formulas, models in memory, poses.
#ifndef WIREPOSE_TESTS_STAGES_STAGE_TEST_SUPPORT_H_
#define WIREPOSE_TESTS_STAGES_STAGE_TEST_SUPPORT_H_

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "hal/dataset/png_image.h"
#include "sim/random.h"
#include "stages/edge_image.h"
#include "stages/edge_map.h"
#include "stages/normalize.h"
#include "stages/segments.h"
#include "stages/stereo_lines.h"

namespace wirepose::testing {

using dataset::GrayImage;
using sim::Random;

// Number of random cases: fewer where the sanitizers make everything ten times slower.
constexpr int Cases(int count) {
#ifdef __SANITIZE_ADDRESS__
  return std::max(1, count / 10);
#else
  return count;
#endif
}

inline RectifiedCamera TestCamera(int width = 640, int height = 480) {
  return {525, 0.5 * (width - 1), 0.5 * (height - 1), 0.12, width, height};
}

// A rectification that leaves the image as it is; only its valid intervals matter to the stages.
inline std::unique_ptr<RectificationMap> WholeImage(int width, int height) {
  auto map = std::make_unique<RectificationMap>();
  for (int y = 0; y < height; ++y) map->valid[static_cast<std::size_t>(y)] = {0, static_cast<std::int16_t>(width)};
  return map;
}

// The grey level at every pixel, rounded and clipped.
inline GrayImage Paint(int width, int height, const std::function<double(int, int)>& level) {
  GrayImage image{width, height, {}};
  image.pixels.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::floor(level(x, y) + 0.5), 0.0, 255.0)));
    }
  }
  return image;
}

inline double Gaussian(Random& random) { return static_cast<double>(sim::NormalFloat(random.Next())); }

// Share of a pixel's light that comes from beyond an edge at signed distance `d_px`: a sharp edge
// seen through a lens and pixel of standard deviation `sigma_px`.
inline double Step(double d_px, double sigma_px = 0.6) { return 0.5 * std::erfc(-d_px / (sigma_px * std::sqrt(2.0))); }

// Smooth noise in -1..1 with details of about `scale`, anywhere in the plane: random lattice values
// with cubic blends.
inline double Texture(double x, double y, double scale, std::uint64_t seed) {
  const auto lattice = [seed](double i, double j) {
    const auto key = (static_cast<std::uint64_t>(static_cast<std::int64_t>(i)) << 32) ^
                     (static_cast<std::uint64_t>(static_cast<std::int64_t>(j)) & 0xFFFFFFFFU);
    return 2 * static_cast<double>(sim::UnitFloat(sim::Mix(seed, key))) - 1;
  };
  const double u = x / scale, v = y / scale;
  const double i = std::floor(u), j = std::floor(v);
  const auto blend = [](double t) { return t * t * (3 - 2 * t); };
  const double a = blend(u - i), b = blend(v - j);
  return (1 - b) * ((1 - a) * lattice(i, j) + a * lattice(i + 1, j)) +
         b * ((1 - a) * lattice(i, j + 1) + a * lattice(i + 1, j + 1));
}

// Every plane that the feature stages make of one image.
struct Planes {
  SmoothPlane smooth;
  NormalizedPlane normalized;
  EdgeImage edges;
  EdgeMap map;
  Segments segments;
  SegmentScratch scratch;
};

inline std::unique_ptr<Planes> FindAll(const GrayImage& image) {
  auto planes = std::make_unique<Planes>();
  const auto whole = WholeImage(image.width, image.height);
  SmoothImage(image.view(), planes->smooth);
  FindRidges(planes->smooth, image.width, image.height, *whole, {}, planes->edges);
  BuildEdgeMap(planes->edges, planes->map);
  FindSegments({}, planes->edges, planes->scratch, planes->segments);
  NormalizeLocally(image.view(), planes->normalized);
  return planes;
}

inline Vector3d AnyDirection(Random& random) {
  while (true) {
    const Vector3d v(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
    if (v.squaredNorm() < 1 && v.squaredNorm() > 0.01) return v.normalized();
  }
}

// Evenly distributed rotation.
inline Matrix3d AnyRotation(Random& random) {
  Eigen::Vector4d q(Gaussian(random), Gaussian(random), Gaussian(random), Gaussian(random));
  q.normalize();
  return Eigen::Quaterniond(q).toRotationMatrix();
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_STAGES_STAGE_TEST_SUPPORT_H_
