#include "sim/shading.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/random.h"

namespace wirepose::sim {
namespace {

constexpr float kShadowOffset = 2e-5F;  // m along the normal, against a surface shadowing itself
constexpr std::size_t kMaxLights = 16;

Vector3 Start(const SurfacePoint& surface) { return surface.place + kShadowOffset * surface.normal; }

// What a light would give if all of it were in its middle: for choosing among lights only.
float Importance(const AreaLight& light, const Vector3& shine, const SurfacePoint& surface) {
  const Vector3 to = light.centre - surface.place;
  const float squared = to.squaredNorm();
  const float per_length = 1 / std::sqrt(squared);
  // A light whose middle is below the horizon may still shine with a part of it.
  const float here = std::max(surface.normal.dot(to) * per_length, 0.1F);
  const float there = std::max(-shine.dot(to) * per_length, 0.02F);
  return light.intensity * here * there * per_length * per_length;
}

// A point of the unit ball, from one hash.
Vector3 InBall(std::uint64_t hash) {
  for (int i = 0; i < 8; ++i, hash = Mix(hash)) {
    const Vector3 p(2 * UnitFloat(hash) - 1, 2 * UnitFloat(hash << 20) - 1, 2 * UnitFloat(hash << 40) - 1);
    if (p.squaredNorm() < 1) return p;
  }
  return Vector3::Zero();
}

}  // namespace

Shader::Shader(const Scene& scene, const RayScene& rays, const std::vector<Bounds>& bounds)
    : scene_(scene), rays_(rays), bounds_(bounds) {
  for (const Instance& instance : scene.instances) {
    frames_.push_back({instance.T_world_object.R.cast<float>().transpose(), instance.T_world_object.t.cast<float>()});
  }
  for (const AreaLight& light : scene.lights) shine_.push_back(light.half_u.cross(light.half_v).normalized());
}

SurfacePoint Shader::At(int instance, const Vector3& place, const Vector3& normal, const Vector3& direction) const {
  const auto index = static_cast<std::size_t>(instance);
  const Material& material = scene_.instances[index].material;
  const Frame& frame = frames_[index];
  SurfacePoint surface;
  surface.place = place;
  surface.normal = normal.normalized();
  if (surface.normal.dot(direction) > 0) surface.normal = -surface.normal;
  surface.instance = instance;
  surface.albedo = AlbedoAt(material, bounds_[index], frame.R_object_world * (place - frame.origin),
                            frame.R_object_world * surface.normal);
  if (material.gloss > 0) {
    const float grazing = 1 + surface.normal.dot(direction) / direction.norm();
    const float squared = grazing * grazing;
    surface.roughness = material.roughness;
    surface.mirrored = material.gloss + (1 - material.gloss) * (1 - material.roughness) * squared * squared * grazing;
  }
  return surface;
}

LightSample Shader::SampleLight(const SurfacePoint& surface, float pick, float across) const {
  const std::size_t count = std::min(scene_.lights.size(), kMaxLights);
  std::array<float, kMaxLights> weights{};
  float sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += weights[i] = Importance(scene_.lights[i], shine_[i], surface);
  if (!(sum > 0)) return {};
  std::size_t chosen = 0;
  float rest = pick * sum;
  while (chosen + 1 < count && rest >= weights[chosen]) rest -= weights[chosen++];
  const AreaLight& light = scene_.lights[chosen];
  const float along = std::clamp(rest / weights[chosen], 0.0F, 1.0F);
  const Vector3 target = light.centre + (2 * along - 1) * light.half_u + (2 * across - 1) * light.half_v;
  LightSample sample;
  sample.start = Start(surface);
  sample.to_light = target - sample.start;
  const float here = surface.normal.dot(sample.to_light), there = -shine_[chosen].dot(sample.to_light);
  if (here <= 0 || there <= 0) return {};
  const float squared = sample.to_light.squaredNorm();
  sample.radiance = light.intensity * here * there / (squared * squared) * sum / weights[chosen];
  return sample;
}

float Shader::Highlight(const SurfacePoint& surface, const Vector3& direction, const Vector3& to_light) {
  if (surface.mirrored <= 0) return 0;
  const Vector3 half = (to_light.normalized() - direction.normalized()).normalized();
  const float exponent = 2 / (surface.roughness * surface.roughness + 1e-4F);
  return surface.mirrored * (exponent + 8) / 8 * std::pow(std::max(surface.normal.dot(half), 0.0F), exponent);
}

float Shader::Ambient(const Vector3& normal) const {
  return scene_.ambient_down + (scene_.ambient_up - scene_.ambient_down) * (0.5F + 0.5F * normal.z());
}

float Shader::Radiance(const Vector3& origin, const Vector3& direction, std::uint64_t hash) const {
  const RayScene::Hit hit = rays_.Intersect(origin, direction);
  if (hit.instance == RayScene::kNothing) return scene_.background;
  const SurfacePoint surface = At(hit.instance, origin + hit.t * direction, hit.normal, direction);
  float light = Ambient(surface.normal);
  const LightSample sample = SampleLight(surface, UnitFloat(hash), UnitFloat(hash << 24));
  if (sample.radiance > 0 && !rays_.IsHidden(sample.start, sample.to_light)) light += sample.radiance;
  return surface.albedo * light;
}

float Shader::Reflection(const SurfacePoint& surface, const Vector3& direction, std::uint64_t hash) const {
  const Vector3 d = direction.normalized();
  const Vector3 mirrored = d - 2 * surface.normal.dot(d) * surface.normal;
  Vector3 blurred = mirrored + surface.roughness * InBall(hash);
  // A blurred ray that would go below the surface comes out above it.
  const float below = surface.normal.dot(blurred);
  if (below < 0) blurred -= 2 * below * surface.normal;
  return Radiance(Start(surface), blurred, Mix(hash, 2));
}

}  // namespace wirepose::sim
