#include "sim/shapes.h"

#include <cmath>
#include <numbers>

namespace wirepose::sim {
namespace {

void Centre(Mesh& mesh) {
  const Vector3 middle = 0.5F * (mesh.Min() + mesh.Max());
  for (Vector3& v : mesh.vertices) v -= middle;
}

}  // namespace

void Append(Mesh& mesh, const Mesh& part, const Vector3& at) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vector3& v : part.vertices) mesh.vertices.push_back(v + at);
  for (const auto& t : part.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Mesh MakeLathe(const std::vector<ProfilePoint>& profile, int sides) {
  Mesh mesh;
  const auto count = static_cast<std::uint32_t>(sides);
  for (const ProfilePoint& p : profile) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(sides);
      mesh.vertices.emplace_back(p.radius * std::cos(angle), p.radius * std::sin(angle), p.z);
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < profile.size(); ++ring) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t a = ring * count + i, b = ring * count + (i + 1) % count;
      mesh.triangles.push_back({a, b, b + count});
      mesh.triangles.push_back({a, b + count, a + count});
    }
  }
  for (const std::uint32_t ring : {std::uint32_t{0}, static_cast<std::uint32_t>(profile.size() - 1)}) {
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(0.0F, 0.0F, profile[ring].z);
    for (std::uint32_t i = 0; i < count; ++i) {
      mesh.triangles.push_back({middle, ring * count + (i + 1) % count, ring * count + i});
    }
  }
  Centre(mesh);
  return mesh;
}

Mesh MakeBottle(float r, float h) {
  return MakeLathe({{0.9F * r, 0},
                    {r, 0.02F * h},
                    {r, 0.55F * h},
                    {0.85F * r, 0.65F * h},
                    {0.4F * r, 0.78F * h},
                    {0.33F * r, 0.93F * h},
                    {0.4F * r, 0.93F * h},
                    {0.4F * r, h}});
}

Mesh MakeMug(float r, float h) {
  Mesh mesh = MakeLathe({{0.9F * r, 0}, {r, 0.05F * h}, {r, h}, {0.9F * r, h}, {0.88F * r, 0.1F * h}});
  const float bar = 0.16F * r;  // the handle: two arms and a grip
  Append(mesh, MakeBox({0.7F * r, bar, bar}), {1.25F * r, 0, 0.25F * h});
  Append(mesh, MakeBox({0.7F * r, bar, bar}), {1.25F * r, 0, -0.25F * h});
  Append(mesh, MakeBox({bar, bar, 0.5F * h + bar}), {1.55F * r, 0, 0});
  return mesh;
}

Mesh MakePlates(float r, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Mesh plate = MakeLathe({{0.6F * r, 0}, {0.65F * r, 0.004F}, {r, 0.022F}, {r, 0.026F}, {0.62F * r, 0.009F}});
    Append(mesh, plate, {0, 0, 0.012F * static_cast<float>(i)});
  }
  Centre(mesh);
  return mesh;
}

Mesh MakeBowl(float r, float h) {
  return MakeLathe({{0.45F * r, 0},
                    {0.75F * r, 0.3F * h},
                    {0.95F * r, 0.7F * h},
                    {r, h},
                    {0.96F * r, h},
                    {0.7F * r, 0.35F * h},
                    {0.4F * r, 0.12F * h}});
}

Mesh MakeGableCarton(const Vector3& size) {
  const float x = size.x() / 2, y = size.y() / 2, wall = 0.8F * size.z(), ridge = 0.94F * size.z();
  Mesh mesh;
  for (const float z : {0.0F, wall}) {
    for (const auto& [sx, sy] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      mesh.vertices.emplace_back(static_cast<float>(sx) * x, static_cast<float>(sy) * y, z);
    }
  }
  mesh.vertices.emplace_back(-x, 0.0F, ridge);
  mesh.vertices.emplace_back(x, 0.0F, ridge);
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6},
                    {3, 0, 4}, {3, 4, 7}, {4, 5, 9}, {4, 9, 8}, {6, 7, 8}, {6, 8, 9}, {5, 6, 9}, {7, 4, 8}};
  Append(mesh, MakeBox({size.x(), 0.004F, 0.06F * size.z()}), {0, 0, 0.97F * size.z()});
  Centre(mesh);
  return mesh;
}

Mesh MakeKnifeBlock(const Vector3& size) {
  Mesh mesh = MakeBox(size);
  for (Vector3& v : mesh.vertices) {
    if (v.z() > 0 && v.y() < 0) v.z() -= 0.3F * size.z();
  }
  for (int i = 0; i < 4; ++i) {
    const float x = size.x() * (-0.33F + 0.22F * static_cast<float>(i));
    const float y = size.y() * (i % 2 == 0 ? 0.2F : -0.05F);
    Append(mesh, MakeBox({0.014F, 0.02F, 0.09F}), {x, y, 0.5F * size.z()});
  }
  Centre(mesh);
  return mesh;
}

}  // namespace wirepose::sim
