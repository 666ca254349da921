#include "sim/indirect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "sim/parallel.h"
#include "sim/random.h"
#include "sim/renderer.h"

namespace wirepose::sim {
namespace {

constexpr float kSameSide = 0.9F;     // cosine between normals of one smooth surface
constexpr float kSamePlane = 0.015F;  // m off the tangent plane
constexpr int kPasses = 2;            // of smoothing, each twice as wide as the one before

// Evenly spread directions about the normal, more of them close to it (cosine distribution).
Vector3 HemisphereDirection(const Vector3& normal, int index, std::uint64_t hash) {
  constexpr int kSide = 4;
  static_assert(kSide * kSide == IndirectLight::kRays);
  const float u = (static_cast<float>(index % kSide) + UnitFloat(hash)) / kSide;
  const float v = (static_cast<float>(index / kSide) + UnitFloat(hash << 24)) / kSide;
  const float radius = std::sqrt(u), angle = 2 * std::numbers::pi_v<float> * v;
  const Vector3 other = std::abs(normal.x()) < 0.5F ? Vector3(1, 0, 0) : Vector3(0, 1, 0);
  const Vector3 a = normal.cross(other).normalized(), b = normal.cross(a);
  return radius * (std::cos(angle) * a + std::sin(angle) * b) + std::sqrt(1 - u) * normal;
}

}  // namespace

IndirectLight::IndirectLight(const Shader& shader, const Camera& camera, int margin, int threads, std::uint64_t seed)
    : shader_(shader),
      margin_(margin),
      width_((camera.width + 2 * margin) / kStep + 2),
      height_((camera.height + 2 * margin) / kStep + 2),
      places_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {
  const Lens lens(camera.intrinsics);
  ForEachRow(height_, threads, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
      places_[i] = Gather(camera, lens, x, y, Mix(seed, i));
    }
  });
  for (int pass = 0, gap = 1; pass < kPasses; ++pass, gap *= 2) {
    const std::vector<float> smoothed = Smoothed(gap, threads);
    for (std::size_t i = 0; i < places_.size(); ++i) places_[i].light = smoothed[i];
  }
}

IndirectLight::Place IndirectLight::Gather(const Camera& camera, const Lens& lens, int x, int y,
                                           std::uint64_t hash) const {
  const std::optional<Lens::Ray> ray = lens.RayOf(Vector2d(x * kStep - margin_, y * kStep - margin_));
  if (!ray) return {};
  const Vector3 origin = camera.T_world_camera.t.cast<float>();
  const Vector3 direction = (camera.T_world_camera.R * Vector3d(ray->xy.x(), ray->xy.y(), 1)).cast<float>();
  const RayScene::Hit hit = shader_.rays().Intersect(origin, direction);
  if (hit.instance == RayScene::kNothing) return {};
  Place place;
  place.instance = hit.instance;
  place.place = origin + hit.t * direction;
  place.normal = hit.normal.normalized();
  if (place.normal.dot(direction) > 0) place.normal = -place.normal;
  constexpr float kOffset = 2e-5F;  // m
  const Vector3 start = place.place + kOffset * place.normal;
  for (int i = 0; i < kRays; ++i) {
    const std::uint64_t h = Mix(hash, static_cast<std::uint64_t>(i));
    place.light += shader_.Radiance(start, HemisphereDirection(place.normal, i, h), Mix(h, 1)) / kRays;
  }
  return place;
}

// One pass of the a-trous wavelet filter (Dammertz et al. 2010): 5 x 5 places that are `gap` apart,
// those of the same surface only.
std::vector<float> IndirectLight::Smoothed(int gap, int threads) const {
  constexpr std::array<float, 3> kKernel = {3.0F / 8, 1.0F / 4, 1.0F / 16};
  std::vector<float> out(places_.size());
  ForEachRow(height_, threads, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      const Place& centre = Get(x, y);
      float sum = 0, weights = 0;
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          const int qx = x + gap * dx, qy = y + gap * dy;
          if (qx < 0 || qy < 0 || qx >= width_ || qy >= height_) continue;
          const Place& q = Get(qx, qy);
          if (q.instance != centre.instance || q.normal.dot(centre.normal) < kSameSide) continue;
          if (std::abs(centre.normal.dot(q.place - centre.place)) > kSamePlane) continue;
          const float weight =
              kKernel[static_cast<std::size_t>(std::abs(dx))] * kKernel[static_cast<std::size_t>(std::abs(dy))];
          sum += weight * q.light;
          weights += weight;
        }
      }
      out[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)] =
          weights > 0 ? sum / weights : 0;
    }
  });
  return out;
}

float IndirectLight::At(const Vector2d& pixel, const SurfacePoint& surface) const {
  const auto gx = static_cast<float>((pixel.x() + margin_) / kStep),
             gy = static_cast<float>((pixel.y() + margin_) / kStep);
  const int x0 = static_cast<int>(std::floor(gx)), y0 = static_cast<int>(std::floor(gy));
  float sum = 0, weights = 0;
  // The four places around the pixel if they are of this surface, else those one further out.
  for (int reach = 0; reach < 2 && weights <= 0; ++reach) {
    for (int y = y0 - reach; y <= y0 + 1 + reach; ++y) {
      for (int x = x0 - reach; x <= x0 + 1 + reach; ++x) {
        if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;
        const Place& q = Get(x, y);
        if (q.instance != surface.instance || q.normal.dot(surface.normal) < kSameSide) continue;
        const float near = 2.01F + static_cast<float>(reach) -
                           std::max(std::abs(gx - static_cast<float>(x)), std::abs(gy - static_cast<float>(y)));
        const float weight = reach == 0 ? std::max(1 - std::abs(gx - static_cast<float>(x)), 0.01F) *
                                              std::max(1 - std::abs(gy - static_cast<float>(y)), 0.01F)
                                        : near;
        sum += weight * q.light;
        weights += weight;
      }
    }
  }
  return weights > 0 ? sum / weights : shader_.Ambient(surface.normal);
}

}  // namespace wirepose::sim
