#include "mesh/ply_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "mesh/polygon.h"
#include "tests/mesh/test_meshes.h"

namespace wirepose {
namespace {

using mesh::Mesh;
using mesh::ParsePly;
using ::testing::HasSubstr;

const char kAsciiBox[] =
    "ply\r\nformat ascii 1.0\ncomment a box with normals and a colour\nelement vertex 4\nproperty "
    "float x\n"
    "property double y\nproperty float nx\nproperty float z\nproperty uchar red\nelement face 2\n"
    "property list uchar int vertex_index\nproperty int material\nelement edge 1\nproperty int "
    "v1\nend_header\n"
    "0 0 9 0 1\n10 0 9 0 1\n10 +20.5 9 0 1\n0 20 9 -1e1 1\n4 0 1 2 3 7\n3 0 2 3 7\n1\n";

template <typename T>
void Put(T value, bool big_endian, std::string& out) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big_endian) std::reverse(std::begin(bytes), std::end(bytes));
  out.append(bytes, sizeof(T));
}

std::string BinaryPly(const Mesh& mesh, bool big_endian) {
  std::string out = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                    "_endian 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                    "\nproperty float x\nproperty double y\nproperty short id\nproperty float z\nelement face " +
                    std::to_string(mesh.triangles.size()) + "\nproperty list ushort uint vertex_indices\nend_header\n";
  for (const auto& v : mesh.vertices) {
    Put(static_cast<float>(v.x()), big_endian, out);
    Put(v.y(), big_endian, out);
    Put(std::int16_t{-2}, big_endian, out);
    Put(static_cast<float>(v.z()), big_endian, out);
  }
  for (const auto& t : mesh.triangles) {
    Put(std::uint16_t{3}, big_endian, out);
    for (const int v : t) Put(static_cast<std::uint32_t>(v), big_endian, out);
  }
  return out;
}

TEST(PlyReader, ReadsAsciiWithForeignPropertiesAndElements) {
  const auto mesh = ParsePly(kAsciiBox, 1e-3);
  ASSERT_TRUE(mesh.has_value()) << mesh.error();
  ASSERT_EQ(mesh->vertices.size(), 4U);
  EXPECT_TRUE(mesh->vertices[2].isApprox(Eigen::Vector3d(0.01, 0.0205, 0)));
  EXPECT_TRUE(mesh->vertices[3].isApprox(Eigen::Vector3d(0, 0.02, -0.01)));
  EXPECT_EQ(mesh->triangles.size(), 3U);  // the quadrilateral gives two
}

TEST(PlyReader, ReadsBothByteOrders) {
  const Mesh mesh = testing::PrismMesh(9, 0.1, 0.3);
  for (const bool big_endian : {false, true}) {
    const auto read = ParsePly(BinaryPly(mesh, big_endian), 1);
    ASSERT_TRUE(read.has_value()) << read.error();
    EXPECT_EQ(read->triangles, mesh.triangles);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      EXPECT_TRUE(read->vertices[i].isApprox(mesh.vertices[i], 1e-6));
  }
}

TEST(PlyReader, RefusesEveryTruncation) {
  const std::string ascii(kAsciiBox);
  for (std::size_t n = 0; n + 2 < ascii.size(); ++n) EXPECT_FALSE(ParsePly(ascii.substr(0, n), 1).has_value()) << n;
  const std::string binary = BinaryPly(testing::PrismMesh(9, 0.1, 0.3), true);
  for (std::size_t n = 0; n < binary.size(); ++n) EXPECT_FALSE(ParsePly(binary.substr(0, n), 1).has_value()) << n;
}

TEST(PlyReader, SurvivesDamage) {
  std::mt19937 random(9);
  const std::string seeds[] = {kAsciiBox, BinaryPly(testing::BoxMesh(1, 2, 3), false)};
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string file = seeds[i % 2];
    for (std::size_t edits = 1 + random() % 4; edits > 0; --edits) {
      const char common[] = "0123456789-.e \n";
      file[random() % file.size()] = random() % 2 == 0 ? static_cast<char>(random()) : common[random() % 15];
    }
    const auto mesh = ParsePly(file, 1);
    if (!mesh) continue;
    ++accepted;
    for (const auto& t : mesh->triangles) {
      for (const int v : t) ASSERT_TRUE(v >= 0 && v < static_cast<int>(mesh->vertices.size())) << i;
    }
  }
  EXPECT_GT(accepted, 1000);
}

TEST(PlyReader, NamesThePlaceOfTheFault) {
  const std::string good(kAsciiBox);
  const auto with = [&](const char* old_text, const char* new_text) {
    std::string text = good;
    text.replace(text.find(old_text), std::strlen(old_text), new_text);
    const auto mesh = ParsePly(text, 1);
    return mesh ? std::string("accepted") : mesh.error();
  };
  EXPECT_THAT(with("ply\r", "plx\r"), HasSubstr("not a PLY file"));
  EXPECT_THAT(with("ascii 1.0", "ascii 2.0"), HasSubstr("line 2"));
  EXPECT_THAT(with("property double y", "property quad y"), HasSubstr("line 6"));
  EXPECT_THAT(with("vertex 4", "vertex -4"), HasSubstr("line 4"));
  EXPECT_THAT(with("face 2", "face 99999999999"), HasSubstr("line 10"));
  EXPECT_THAT(with("10 +20.5", "10 oops"), HasSubstr("vertex 2 of 4"));
  EXPECT_THAT(with("0 20 9", "nan 20 9"), HasSubstr("vertex 3 of 4"));
  EXPECT_THAT(with("3 0 2 3", "3 0 2 4"), HasSubstr("face 1 of 2"));
  EXPECT_THAT(with("3 0 2 3", "2 0 2 3"), HasSubstr("face 1 of 2"));
}

// --- Polygons
// -----------------------------------------------------------------------------------------------------------

TEST(Polygon, TrianglesCoverConcavePolygonsExactly) {
  std::mt19937 random(10);
  std::uniform_real_distribution<double> radius(0.2, 1.0);
  for (int i = 0; i < 300; ++i) {
    // Star-shaped about the origin, in a tilted plane: simple, mostly concave.
    const Eigen::Matrix3d R = Eigen::Quaterniond(1, radius(random), radius(random), 0).normalized().toRotationMatrix();
    Mesh mesh;
    std::vector<int> polygon;
    const int corners = 3 + i % 20;
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    for (int k = 0; k < corners; ++k) {
      const double a = 2 * M_PI * k / corners, r = radius(random);
      mesh.vertices.emplace_back(R * Eigen::Vector3d(r * std::cos(a), r * std::sin(a), 0));
      polygon.push_back(k);
    }
    for (int k = 0; k < corners; ++k) area += mesh.vertices[k].cross(mesh.vertices[(k + 1) % corners]);
    mesh::AppendPolygon(polygon, mesh);
    ASSERT_EQ(mesh.triangles.size(), static_cast<std::size_t>(corners - 2));
    double total = 0;
    for (const auto& t : mesh.triangles) {
      EXPECT_GE(mesh.AreaNormal(t).dot(area), -1e-12) << "the sense of rotation is kept";
      total += mesh.AreaNormal(t).norm();
    }
    EXPECT_NEAR(total, area.norm(), 1e-9) << "no overlap, no gap";
  }
}

}  // namespace
}  // namespace wirepose
