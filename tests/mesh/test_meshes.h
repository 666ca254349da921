// Small meshes whose wireframes are known by heart. Metres.
#ifndef WIREPOSE_TESTS_MESH_TEST_MESHES_H_
#define WIREPOSE_TESTS_MESH_TEST_MESHES_H_

#include <algorithm>
#include <cmath>
#include <random>

#include "mesh/mesh.h"

namespace wirepose::testing {

using mesh::Mesh;

// Twelve outward triangles over eight vertices, centred at `centre`.
inline Mesh BoxMesh(double x, double y, double z, const Eigen::Vector3d& centre = Eigen::Vector3d::Zero()) {
  Mesh mesh;
  for (const double sz : {-0.5, 0.5}) {
    for (const double sy : {-0.5, 0.5}) {
      for (const double sx : {-0.5, 0.5}) mesh.vertices.emplace_back(centre + Eigen::Vector3d(sx * x, sy * y, sz * z));
    }
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// A closed prism over a regular polygon: a tessellated cylinder about z.
inline Mesh PrismMesh(int sides, double radius, double height) {
  Mesh mesh;
  for (int i = 0; i < sides; ++i) {
    const double a = 2 * M_PI * i / sides;
    mesh.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), -height / 2);
    mesh.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), height / 2);
  }
  for (int i = 0; i < sides; ++i) {
    const int a = 2 * i, b = 2 * ((i + 1) % sides);
    mesh.triangles.push_back({a, b, a + 1});
    mesh.triangles.push_back({b, b + 1, a + 1});
    if (i > 0 && i < sides - 1) {
      mesh.triangles.push_back({0, b, a});
      mesh.triangles.push_back({1, a + 1, b + 1});
    }
  }
  return mesh;
}

inline void Append(const Mesh& other, Mesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

// Every triangle with vertices of its own, as an STL file has them.
inline Mesh Soup(const Mesh& mesh) {
  Mesh soup;
  for (const auto& t : mesh.triangles) {
    const int first = static_cast<int>(soup.vertices.size());
    for (const int v : t) soup.vertices.push_back(mesh.vertices[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

// The same surface with vertices and triangles in another order and each triangle begun at another
// corner.
inline Mesh Shuffled(const Mesh& mesh, std::mt19937& random) {
  std::vector<int> place(mesh.vertices.size());
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = static_cast<int>(i);
  std::shuffle(place.begin(), place.end(), random);
  Mesh out = mesh;
  for (std::size_t i = 0; i < place.size(); ++i) out.vertices[place[i]] = mesh.vertices[i];
  for (auto& t : out.triangles) {
    for (int& v : t) v = place[v];
    std::rotate(t.begin(), t.begin() + static_cast<int>(random() % 3), t.end());
  }
  std::shuffle(out.triangles.begin(), out.triangles.end(), random);
  return out;
}

// A table-like L: a box on a larger plate, sharing no vertices. 24 creases, some hidden by the
// other part.
inline Mesh TwoPartMesh() {
  Mesh mesh = BoxMesh(0.3, 0.2, 0.04);
  Append(BoxMesh(0.1, 0.08, 0.2, {0.05, 0.03, 0.12}), mesh);
  return mesh;
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_MESH_TEST_MESHES_H_
