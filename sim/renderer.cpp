#include "sim/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/lens.h"
#include "sim/parallel.h"
#include "sim/random.h"

namespace wirepose::sim {
namespace {

constexpr int kLanes = RayScene::kPacket;
constexpr float kShadowOffset = 2e-5F;  // m along the normal, against a surface shadowing itself
constexpr int kMaxSide = 6;

// The samples of a whole image, some pixels wider than it on each side for the point spread to draw
// from.
struct Film {
  Film(const Camera& camera, int samples_per_side)
      : side(samples_per_side),
        margin(static_cast<int>(std::ceil(3 * camera.psf_sigma_px))),
        width((camera.width + 2 * margin) * side),
        height((camera.height + 2 * margin) * side),
        samples(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

  float* row(int y) { return samples.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }

  int side;           // samples a pixel, along each axis
  int margin;         // px
  int width, height;  // samples
  std::vector<float> samples;
};

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

// What a camera ray met, and the shadow ray's share of it.
struct Shading {
  float ambient = 0;  // radiance without the light
  float direct = 0;   // radiance the light adds unless it is hidden
};

class PixelTracer {
 public:
  PixelTracer(const Renderer& renderer, const Camera& camera, const RenderOptions& options)
      : renderer_(renderer),
        scene_(renderer.scene()),
        side_(options.samples_per_side),
        R_world_camera_(camera.T_world_camera.R),
        origin_(camera.T_world_camera.t.cast<float>()) {}

  // Writes the side x side samples of one pixel; `out` is its first sample, `stride` leads to the
  // next row of samples.
  void Trace(const Lens& lens, const Vector2d& pixel, std::uint64_t hash, float* out, std::ptrdiff_t stride) const {
    const std::optional<Lens::Ray> centre = lens.RayOf(pixel);
    const PixelSamples places(side_, hash);
    const int count = side_ * side_;
    for (int first = 0; first < count; first += kLanes) {
      std::array<float, kLanes> radiance{};
      if (centre) TracePacket(*centre, places, hash, first, std::min(kLanes, count - first), radiance);
      for (int k = 0; k < kLanes && first + k < count; ++k) {
        const int i = (first + k) % side_, j = (first + k) / side_;
        out[j * stride + i] = radiance[static_cast<std::size_t>(k)];
      }
    }
  }

 private:
  void TracePacket(const Lens::Ray& centre, const PixelSamples& places, std::uint64_t hash, int first, int count,
                   std::array<float, kLanes>& radiance) const {
    alignas(64) RTCRayHit16 query;
    alignas(64) RTCRay16 shadow;
    alignas(64) std::array<int, kLanes> valid{};
    for (int k = 0; k < count; ++k) {
      const int sample = first + k;
      const Vector2d offset = places.Offset(sample % side_, sample / side_);
      // The distortion is straight within a pixel to 1e-4 px, so its derivative serves all samples.
      const Vector2d xy = centre.xy + centre.dxy_dpixel * offset;
      const Vector3d direction = R_world_camera_ * Vector3d(xy.x(), xy.y(), 1);
      SetRay(query.ray, k, origin_, direction.cast<float>(), std::numeric_limits<float>::infinity());
      query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      valid[static_cast<std::size_t>(k)] = -1;
    }
    renderer_.rays().Intersect(valid.data(), query);

    std::array<Shading, kLanes> shading;
    alignas(64) std::array<int, kLanes> shadow_valid{};
    for (int k = 0; k < count; ++k) {
      const auto lane = static_cast<std::size_t>(k);
      shading[lane] = Shade(query, k, (hash >> 32) + static_cast<std::uint64_t>(first + k), hash, shadow);
      shadow_valid[lane] = shading[lane].direct > 0 ? -1 : 0;
    }
    renderer_.rays().Occluded(shadow_valid.data(), shadow);
    for (int k = 0; k < count; ++k) {
      const auto lane = static_cast<std::size_t>(k);
      const bool lit = shadow_valid[lane] != 0 && shadow.tfar[k] >= 0;
      radiance[lane] = shading[lane].ambient + (lit ? shading[lane].direct : 0);
    }
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

  // Shades lane `k` and sets up its shadow ray. `sample` counts up within the pixel, so that lights
  // and the places on them are spread evenly over its samples.
  Shading Shade(const RTCRayHit16& query, int k, std::uint64_t sample, std::uint64_t hash, RTCRay16& shadow) const {
    if (query.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) return {scene_.background, 0};
    const auto index = static_cast<std::size_t>(query.hit.geomID[k]);
    const Instance& instance = scene_.instances[index];
    const Vector3 direction(query.ray.dir_x[k], query.ray.dir_y[k], query.ray.dir_z[k]);
    Vector3 normal = Vector3(query.hit.Ng_x[k], query.hit.Ng_y[k], query.hit.Ng_z[k]).normalized();
    if (normal.dot(direction) > 0) normal = -normal;
    const Vector3 place = origin_ + query.ray.tfar[k] * direction;

    const Matrix3 R = instance.T_world_object.R.cast<float>();
    const Vector3 p = R.transpose() * (place - instance.T_world_object.t.cast<float>());
    const float albedo = AlbedoAt(instance.material, renderer_.bounds(index), p, R.transpose() * normal);
    const float up = 0.5F + 0.5F * normal.z();
    const float ambient = scene_.ambient_down + (scene_.ambient_up - scene_.ambient_down) * up;
    return {albedo * ambient, albedo * Light(place, normal, k, sample, hash, shadow)};
  }

  // Radiance of a white surface from one random point of one light, as if it were all the light
  // there is.
  float Light(const Vector3& place, const Vector3& normal, int k, std::uint64_t sample, std::uint64_t hash,
              RTCRay16& shadow) const {
    const std::size_t lights = scene_.lights.size();
    if (lights == 0) return 0;
    const AreaLight& light = scene_.lights[sample % lights];
    // One cell of an n x n grid on the light for each sample; the factor n + 1 keeps them apart
    // from the pixel's cells.
    const auto n = static_cast<std::uint64_t>(side_);
    const std::uint64_t cell = (sample / lights * (n + 1) + (hash & 0xFFFF)) % (n * n);
    const std::uint64_t h = Mix(hash, 1000 + sample);
    const float u = (static_cast<float>(cell % n) + UnitFloat(h)) / static_cast<float>(n);
    const float v = (static_cast<float>(cell / n) + UnitFloat(h << 24)) / static_cast<float>(n);
    const Vector3 target = light.centre + (2 * u - 1) * light.half_u + (2 * v - 1) * light.half_v;
    const Vector3 start = place + kShadowOffset * normal;
    const Vector3 to_light = target - start;
    const float distance_squared = to_light.squaredNorm();
    const Vector3 shine = light.half_u.cross(light.half_v).normalized();
    const float cosines = normal.dot(to_light) * -shine.dot(to_light) / distance_squared;
    if (normal.dot(to_light) <= 0 || cosines <= 0) return 0;
    SetRay(shadow, k, start, to_light, 0.9999F);
    return static_cast<float>(lights) * light.intensity * cosines / distance_squared;
  }

  const Renderer& renderer_;
  const Scene& scene_;
  int side_;
  Matrix3d R_world_camera_;
  Vector3 origin_;
};

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

// Blurs and samples down: along the rows first, then along the columns.
RadianceImage Develop(Film& film, const Camera& camera, int threads) {
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
  return image;
}

}  // namespace

Renderer::Renderer(Scene scene) : scene_(std::move(scene)), rays_(scene_) {
  for (const Instance& instance : scene_.instances) {
    const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(instance.mesh)];
    bounds_.push_back({mesh.Min(), mesh.Max()});
  }
}

RadianceImage Renderer::Render(const Camera& camera, const RenderOptions& options) const {
  Film film(camera, options.samples_per_side);
  const Lens lens(camera.intrinsics);
  const PixelTracer tracer(*this, camera, options);
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
