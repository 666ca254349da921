#include "oriented_points.h"

#include <algorithm>
#include <array>
#include <map>

namespace wirepose::bench {

std::vector<OrientedPoint> Sample(const mesh::Mesh& mesh, double step_m) {
  double volume = 0;
  const auto corner = [&](const std::array<int, 3>& t, std::size_t k) {
    return mesh.vertices[static_cast<std::size_t>(t[k])];
  };
  for (const auto& t : mesh.triangles) volume += corner(t, 0).dot(corner(t, 1).cross(corner(t, 2)));
  std::vector<OrientedPoint> points;
  cv::RNG random(7);
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = corner(t, 0), ab = corner(t, 1) - a, ac = corner(t, 2) - a;
    const Eigen::Vector3d normal = ab.cross(ac) * (volume > 0 ? 1 : -1);
    if (normal.norm() < 1e-12) continue;
    const Eigen::Vector3f n = normal.normalized().cast<float>();
    const int count = std::max(1, cvCeil(normal.norm() / 2 / (step_m * step_m)));
    for (int i = 0; i < count; ++i) {
      double u = random.uniform(0.0, 1.0), v = random.uniform(0.0, 1.0);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Eigen::Vector3f p = (a + u * ab + v * ac).cast<float>();
      points.push_back({{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}});
    }
  }
  return points;
}

std::vector<OrientedPoint> Thin(const std::vector<OrientedPoint>& points, double step_m) {
  constexpr float kSameNormal = 0.85F;
  struct Sum {
    cv::Vec3f point, normal;
    int count;
  };
  std::map<std::array<int, 3>, std::vector<Sum>> cells;
  for (const OrientedPoint& p : points) {
    std::array<int, 3> key{};
    for (int k = 0; k < 3; ++k) key[static_cast<std::size_t>(k)] = cvFloor(static_cast<double>(p.point[k]) / step_m);
    std::vector<Sum>& cell = cells[key];
    const auto same = [&](const Sum& s) {
      return s.normal.dot(p.normal) > kSameNormal * static_cast<float>(cv::norm(s.normal));
    };
    const auto found = std::find_if(cell.begin(), cell.end(), same);
    if (found == cell.end()) {
      cell.push_back({p.point, p.normal, 1});
      continue;
    }
    found->point += p.point;
    found->normal += p.normal;
    ++found->count;
  }
  std::vector<OrientedPoint> thin;
  for (const auto& [key, cell] : cells) {
    for (const Sum& s : cell) thin.push_back({s.point / static_cast<float>(s.count), s.normal / cv::norm(s.normal)});
  }
  return thin;
}

std::vector<OrientedPoint> Candidates(const DenseCloud& cloud, double diameter_m) {
  std::vector<OrientedPoint> points;
  for (int y = 0; y < cloud.points.rows; ++y) {
    for (int x = 0; x < cloud.points.cols; ++x) {
      const int region = cloud.regions(y, x);
      if (region < 0) continue;
      if (static_cast<double>(cloud.extents[static_cast<std::size_t>(region)]) > kLargePlaneD * diameter_m) continue;
      points.push_back({cloud.points(y, x), cloud.normals(y, x)});
    }
  }
  return points;
}

std::vector<OrientedPoint> Near(const std::vector<OrientedPoint>& points, const cv::Vec3f& centre, double radius_m) {
  std::vector<OrientedPoint> near;
  for (const OrientedPoint& p : points) {
    if (cv::norm(p.point - centre) < radius_m) near.push_back(p);
  }
  return near;
}

std::vector<std::vector<int>> Tiles(const std::vector<OrientedPoint>& scene, double diameter_m) {
  constexpr std::size_t kFewest = 20;
  std::map<std::array<int, 3>, std::pair<cv::Vec3f, int>> cells;
  for (const OrientedPoint& p : scene) {
    std::array<int, 3> key{};
    for (int k = 0; k < 3; ++k)
      key[static_cast<std::size_t>(k)] = cvFloor(static_cast<double>(p.point[k]) / (0.5 * diameter_m));
    auto& [sum, count] = cells[key];
    sum += p.point;
    ++count;
  }
  std::vector<std::vector<int>> tiles;
  for (const auto& [key, cell] : cells) {
    if (cell.second < 4) continue;
    const cv::Vec3f centre = cell.first / static_cast<float>(cell.second);
    std::vector<int> tile;
    for (std::size_t i = 0; i < scene.size(); ++i) {
      if (cv::norm(scene[i].point - centre) < 0.6 * diameter_m) tile.push_back(static_cast<int>(i));
    }
    if (tile.size() >= kFewest) tiles.push_back(std::move(tile));
  }
  return tiles;
}

}  // namespace wirepose::bench
