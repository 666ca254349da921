#include "made_models.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

namespace wirepose::bench {
namespace {

constexpr double kShortest_m = 0.08, kLongest_m = 0.6;
constexpr double kAlike = 0.15;  // of a side: two objects that differ by less could be taken for each other
constexpr int kCorners[] = {4, 3, 4, 5, 4, 6, 4, 8};

// Not a distribution of the standard library: its numbers differ from library to library.
double Side(std::mt19937& random) {
  const double share = static_cast<double>(random()) / 4294967296.0;
  return kShortest_m * std::pow(kLongest_m / kShortest_m, share);
}

bool AreAlike(const Sides& a, const Sides& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return std::abs(x - y) <= kAlike * y; });
}

Sides DrawSides(std::mt19937& random, std::span<const Sides> avoided) {
  for (;;) {
    Sides sides{Side(random), Side(random), Side(random)};
    std::ranges::sort(sides);
    if (std::ranges::none_of(avoided, [&](const Sides& other) { return AreAlike(sides, other); })) return sides;
  }
}

// A regular polygon stretched to the first two sides, drawn out along the third. Four corners make a box.
mesh::Mesh Prism(int corners, const Sides& sides) {
  std::vector<Eigen::Vector2d> outline;
  Eigen::AlignedBox2d box;
  for (int k = 0; k < corners; ++k) {
    const double angle = (2 * k + 1) * std::numbers::pi / corners;
    outline.emplace_back(std::cos(angle), std::sin(angle));
    box.extend(outline.back());
  }
  mesh::Mesh mesh;
  for (const double z : {0.0, sides[2]}) {
    for (const Eigen::Vector2d& p : outline) {
      const Eigen::Vector2d share = (p - box.min()).cwiseQuotient(box.sizes());
      mesh.vertices.emplace_back(share.x() * sides[0], share.y() * sides[1], z);
    }
  }
  for (int k = 0; k < corners; ++k) {
    const int next = (k + 1) % corners;
    mesh.triangles.push_back({k, next, corners + next});
    mesh.triangles.push_back({k, corners + next, corners + k});
    if (k == 0 || next == 0) continue;
    mesh.triangles.push_back({0, next, k});
    mesh.triangles.push_back({corners, corners + k, corners + next});
  }
  return mesh;
}

}  // namespace

Sides SidesOf(const ModelView& model) {
  const Vector3 size = model.box_max_m - model.box_min_m;
  Sides sides{double{size.x()}, double{size.y()}, double{size.z()}};
  std::ranges::sort(sides);
  return sides;
}

std::vector<tools::CompiledModel> MakeModels(std::size_t count, std::uint32_t first_id, std::uint32_t seed,
                                             std::span<const Sides> avoided) {
  std::mt19937 random(seed);
  std::vector<tools::CompiledModel> models;
  for (std::size_t i = 0; i < count; ++i) {
    tools::CompileOptions options;
    options.id = first_id + static_cast<std::uint32_t>(i);
    options.name = "made_" + std::to_string(i);
    auto model = tools::CompileModel(Prism(kCorners[i % std::size(kCorners)], DrawSides(random, avoided)), options);
    if (!model) throw std::runtime_error(options.name + ": " + model.error());
    models.push_back(std::move(*model));
  }
  return models;
}

}  // namespace wirepose::bench
