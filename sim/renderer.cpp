#include "sim/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/check.h"
#include "sim/film.h"
#include "sim/indirect.h"
#include "sim/lens.h"
#include "sim/parallel.h"
#include "sim/random.h"
#include "sim/shading.h"

namespace wirepose::sim {
namespace {

constexpr int kLanes = RayScene::kPacket;
constexpr int kMaxSide = 6;

// Places within one pixel, multi-jittered (Chiu, Shirley, Wang 1994): one in each cell of the grid,
// and all in different rows and columns of the finer grid. Edges along the pixel rows are then
// sampled as well as slanted ones.
class PixelSamples {
 public:
  PixelSamples(int side, std::uint64_t hash) : side_(side), hash_(hash) {
    Shuffle(across_, Mix(hash, 1));
    Shuffle(down_, Mix(hash, 2));
  }

  // Offset from the pixel's centre, in (-0.5, 0.5), of the sample in cell (i, j).
  [[nodiscard]] Vector2d Offset(int i, int j) const {
    const std::uint64_t h = Mix(hash_, 3U + static_cast<std::uint64_t>(i + side_ * j));
    const double n = side_;
    const double fine_x = (across_[static_cast<std::size_t>(j)] + double{UnitFloat(h)}) / n;
    const double fine_y = (down_[static_cast<std::size_t>(i)] + double{UnitFloat(h << 24)}) / n;
    return {(i + fine_x) / n - 0.5, (j + fine_y) / n - 0.5};
  }

 private:
  void Shuffle(std::array<int, kMaxSide>& order, std::uint64_t hash) const {
    for (int i = 0; i < side_; ++i) order[static_cast<std::size_t>(i)] = i;
    for (int i = side_ - 1; i > 0; --i) {
      const auto j = static_cast<std::size_t>(hash % static_cast<std::uint64_t>(i + 1));
      hash /= static_cast<std::uint64_t>(i + 1);
      std::swap(order[static_cast<std::size_t>(i)], order[j]);
    }
  }

  int side_;
  std::uint64_t hash_;
  std::array<int, kMaxSide> across_{}, down_{};
};

// Spreads numbers over the samples of one pixel: the k-th of `count` evenly spaced ones, shuffled so
// that neighbouring samples get distant ones, and turned by a random part of the whole.
float Spread(int sample, int count, int stride, float turn) {
  const float even = static_cast<float>(sample * stride % count) / static_cast<float>(count) + turn;
  return even - std::floor(even);
}

// Bits in reverse after the point: evenly spread for any number of samples.
float RadicalInverse(std::uint32_t i) {
  std::uint32_t reversed = 0;
  for (int bit = 0; bit < 24; ++bit) reversed |= ((i >> bit) & 1U) << (23 - bit);
  return static_cast<float>(reversed) * 0x1.0p-24F;
}

class PixelTracer {
 public:
  PixelTracer(const Shader& shader, const IndirectLight* indirect, const Camera& camera, const RenderOptions& options,
              float background)
      : shader_(shader),
        indirect_(indirect),
        camera_(camera),
        side_(options.samples_per_side),
        seed_(Mix(options.seed, 3)),
        background_(background) {}

  // Writes the side x side samples of one pixel; `out` is its first sample, `stride` leads to the
  // next row of samples.
  void Trace(const Lens& lens, const Vector2d& pixel, std::uint64_t hash, float* out, std::ptrdiff_t stride) const {
    const std::optional<Lens::Ray> centre = lens.RayOf(pixel);
    const PixelSamples places(side_, hash);
    const int count = side_ * side_;
    for (int first = 0; first < count; first += kLanes) {
      std::array<float, kLanes> radiance{};
      if (centre) TracePacket({pixel, *centre, places, hash}, first, std::min(kLanes, count - first), radiance);
      for (int k = 0; k < kLanes && first + k < count; ++k) {
        const int i = (first + k) % side_, j = (first + k) / side_;
        out[j * stride + i] = radiance[static_cast<std::size_t>(k)];
      }
    }
  }

 private:
  struct Pixel {
    const Vector2d& centre;
    const Lens::Ray& ray;
    const PixelSamples& places;
    std::uint64_t hash;
  };
  struct CameraRay {
    Vector3 origin, direction;
  };

  void TracePacket(const Pixel& pixel, int first, int count, std::array<float, kLanes>& radiance) const {
    // Lanes that no sample uses hold zeros: Embree's kernels for eight lanes check them as well.
    alignas(64) RTCRayHit16 query{};
    alignas(64) RTCRay16 shadow{};
    alignas(64) std::array<int, kLanes> valid{}, shadow_valid{};
    std::array<CameraRay, kLanes> rays;
    for (int k = 0; k < count; ++k) {
      const auto lane = static_cast<std::size_t>(k);
      rays[lane] = Ray(pixel, first + k);
      SetRay(query.ray, k, rays[lane].origin, rays[lane].direction, std::numeric_limits<float>::infinity());
      query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      valid[lane] = -1;
    }
    shader_.rays().Intersect(valid.data(), query);

    std::array<float, kLanes> direct{};
    for (int k = 0; k < count; ++k) {
      const auto lane = static_cast<std::size_t>(k);
      if (query.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) {
        radiance[lane] = background_;
        continue;
      }
      const CameraRay& ray = rays[lane];
      const SurfacePoint surface =
          shader_.At(static_cast<int>(query.hit.geomID[k]), ray.origin + query.ray.tfar[k] * ray.direction,
                     {query.hit.Ng_x[k], query.hit.Ng_y[k], query.hit.Ng_z[k]}, ray.direction);
      const LightSample light = SampleLight(pixel, surface, first + k);
      const float matt = surface.albedo * (1 - surface.mirrored);
      radiance[lane] =
          matt * (indirect_ != nullptr ? indirect_->At(pixel.centre, surface) : shader_.Ambient(surface.normal));
      if (surface.mirrored > 0) {
        const std::uint64_t h = Mix(pixel.hash, 2000 + static_cast<std::uint64_t>(first + k));
        radiance[lane] += surface.mirrored * shader_.Reflection(surface, ray.direction, h);
      }
      if (light.radiance <= 0) continue;
      direct[lane] = light.radiance * (matt + Shader::Highlight(surface, ray.direction, light.to_light));
      shadow_valid[lane] = -1;
      SetRay(shadow, k, light.start, light.to_light, 0.9999F);
    }
    shader_.rays().Occluded(shadow_valid.data(), shadow);
    for (int k = 0; k < count; ++k) {
      const auto lane = static_cast<std::size_t>(k);
      if (shadow_valid[lane] != 0 && shadow.tfar[k] >= 0) radiance[lane] += direct[lane];
    }
  }

  [[nodiscard]] CameraRay Ray(const Pixel& pixel, int sample) const {
    const Vector2d offset = pixel.places.Offset(sample % side_, sample / side_);
    // The distortion is straight within a pixel to 1e-4 px, so its derivative serves all samples.
    const Vector2d xy = pixel.ray.xy + pixel.ray.dxy_dpixel * offset;
    Vector3d direction = camera_.T_world_camera.R * Vector3d(xy.x(), xy.y(), 1);
    Vector3d origin = camera_.T_world_camera.t;
    if (camera_.exposure_s > 0) {
      const int count = side_ * side_;
      const float part = Spread(sample, count, 11, UnitFloat(Mix(pixel.hash, 5))) - 0.5F;
      const double t = double{part} * camera_.exposure_s;
      origin += t * camera_.velocity;
      direction += t * camera_.rotation_rate.cross(direction);
    }
    return {origin.cast<float>(), direction.cast<float>()};
  }

  [[nodiscard]] LightSample SampleLight(const Pixel& pixel, const SurfacePoint& surface, int sample) const {
    const int count = side_ * side_;
    const float pick = Spread(sample, count, 7, PartOfTile(pixel) / static_cast<float>(count));
    const float across = RadicalInverse(static_cast<std::uint32_t>(sample)) + UnitFloat(Mix(pixel.hash, 4));
    return shader_.SampleLight(surface, pick, across - std::floor(across));
  }

  // A random number in each pixel of which the 16 of a tile of 4 x 4 are evenly spread: neighbours
  // then make different errors, which the point spread levels out.
  [[nodiscard]] float PartOfTile(const Pixel& pixel) const {
    const auto x = static_cast<std::uint64_t>(static_cast<std::int64_t>(pixel.centre.x()) + 64);
    const auto y = static_cast<std::uint64_t>(static_cast<std::int64_t>(pixel.centre.y()) + 64);
    const std::uint64_t tile = Mix(seed_, ((y / 4) << 32) | (x / 4));
    const std::uint64_t order = ((4 * (y % 4) + x % 4) * (2 * (tile & 7) + 1) + (tile >> 8)) % 16;
    return (static_cast<float>(order) + UnitFloat(pixel.hash)) / 16;
  }

  static void SetRay(RTCRay16& ray, int k, const Vector3& origin, const Vector3& direction, float far) {
    ray.org_x[k] = origin.x();
    ray.org_y[k] = origin.y();
    ray.org_z[k] = origin.z();
    ray.dir_x[k] = direction.x();
    ray.dir_y[k] = direction.y();
    ray.dir_z[k] = direction.z();
    ray.tnear[k] = 0;
    ray.tfar[k] = far;
    ray.time[k] = 0;
    ray.mask[k] = ~0U;
    ray.id[k] = 0;
    ray.flags[k] = 0;
  }

  const Shader& shader_;
  const IndirectLight* indirect_;  // null: ambient light instead
  const Camera& camera_;
  int side_;
  std::uint64_t seed_;
  float background_;
};

}  // namespace

Renderer::Renderer(Scene scene) : scene_(std::move(scene)), rays_(scene_) {
  constexpr std::size_t kMaxLights = 16;
  Check(scene_.lights.size() <= kMaxLights);
  for (const Instance& instance : scene_.instances) {
    const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(instance.mesh)];
    bounds_.push_back({mesh.Min(), mesh.Max()});
  }
}

RadianceImage Renderer::Render(const Camera& camera, const RenderOptions& options) const {
  Film film(camera, options.samples_per_side);
  const Lens lens(camera.intrinsics);
  const Shader shader(scene_, rays_, bounds_);
  std::optional<IndirectLight> indirect;
  if (options.is_indirect) indirect.emplace(shader, camera, film.margin, options.threads, Mix(options.seed, 77));
  const PixelTracer tracer(shader, indirect ? &*indirect : nullptr, camera, options, scene_.background);
  ForEachRow(camera.height + 2 * film.margin, options.threads, [&](int y) {
    for (int x = 0; x < camera.width + 2 * film.margin; ++x) {
      const std::uint64_t place = (static_cast<std::uint64_t>(y) << 32) | static_cast<std::uint64_t>(x);
      tracer.Trace(lens, Vector2d(x - film.margin, y - film.margin), Mix(options.seed, place),
                   film.row(y * film.side) + x * film.side, film.width);
    }
  });
  return Develop(film, camera, options.threads);
}

}  // namespace wirepose::sim
